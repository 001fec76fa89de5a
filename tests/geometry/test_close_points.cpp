// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/close_points.h"

#include <random>
#include <set>

#include "tests/catch.h"

using namespace swage;

namespace {

using Pairs = std::set<std::pair<int, int>>;

Pairs each_with_each(const std::vector<Vec3>& point, double gap) {
    Pairs pairs;
    for (int a = 0; a < static_cast<int>(point.size()); ++a)
        for (int b = a + 1; b < static_cast<int>(point.size()); ++b)
            if ((point[b] - point[a]).norm() <= gap) pairs.insert({a, b});
    return pairs;
}

Pairs close_pairs(const std::vector<Vec3>& point, double gap) {
    Pairs pairs;
    for_each_close_pair(point, gap, [&](int a, int b) {
        CHECK(pairs.insert(std::minmax(a, b)).second);  // once
    });
    return pairs;
}

}  // namespace

TEST_CASE("close points are those that a comparison of each with each finds") {
    std::mt19937 random(5);
    const auto number = [&] { return random() / 4294967296.0 - 0.5; };
    for (const double spread : {0.02, 0.3, 3.0}) {
        std::vector<Vec3> cloud, plane;
        for (int n = 0; n < 700; ++n) {
            cloud.emplace_back(100 + spread * number(), spread * number(), spread * number());
            plane.emplace_back(-7, spread * number(), spread * number());
        }
        for (const double gap : {1e-4, 0.01, 0.1}) {
            INFO("spread " << spread << ", gap " << gap);
            CHECK(close_pairs(cloud, gap) == each_with_each(cloud, gap));
            CHECK(close_pairs(plane, gap) == each_with_each(plane, gap));
        }
    }
}

TEST_CASE("points exactly the gap apart, or at one place, are close") {
    std::vector<Vec3> point;
    for (int n = 0; n < 1000; ++n) point.push_back(0.1 * Vec3(n % 10, n / 10 % 10, n / 100));
    point.push_back(point[333]);
    for (const double gap : {0.0, 1e-15, 0.05, 0.1, 0.1 * std::sqrt(2.0), 0.2})
        CHECK(close_pairs(point, gap) == each_with_each(point, gap));
    CHECK(close_pairs({}, 0.1).empty());
    CHECK(close_pairs({Vec3::Ones(), Vec3::Ones()}, 0).size() == 1);
}
