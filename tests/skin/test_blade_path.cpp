// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/blade_path.h"

#include <functional>

#include "tests/catch.h"

using namespace swage;

TEST_CASE("what a blade sweeps forth and back lies in one plane, with one outline") {
    // Two squares beside each other, at z = 0.5; the second is swept backwards.
    const auto at = [](double x, double y) { return Vec3(x, y, 0.5); };
    const std::vector<std::array<Vec3, 3>> sweep = {{at(0, 0), at(1, 0), at(1, 1)},
                                                    {at(0, 0), at(1, 1), at(0, 1)},
                                                    {at(1, 0), at(2, 1), at(2, 0)},
                                                    {at(1, 0), at(1, 1), at(2, 1)}};
    const auto plane = flat_path(sweep, 1e-9);
    REQUIRE(plane);
    CHECK(std::abs(plane->normal.z()) == Approx(1));
    CHECK((plane->point - Vec3(1, 0.5, 0.5)).norm() < 1e-12);
    CHECK(plane->outline.size() == 6);
    double length = 0;
    for (const auto& [from, to] : plane->outline) length += (to - from).norm();
    CHECK(length == Approx(6));
    // Near the area is what is no farther from it than that, beside its edges too.
    const auto is_near = [&](double x, double y, double reach) {
        return plane->near(plane->flat(at(x, y)), reach);
    };
    for (double x : {0.3, 0.7, 1.3, 1.7}) CHECK(is_near(x, 0.4, 0));
    CHECK(is_near(0.5, -0.09, 0.1));
    CHECK(!is_near(0.5, -0.11, 0.1));
    CHECK(!is_near(0.5, -0.09, 0));
    CHECK(is_near(-0.07, -0.07, 0.1));
    CHECK(!is_near(-0.08, -0.08, 0.1));
}

TEST_CASE("a blade at rest beside what another cuts has no path that bends") {
    const auto strip = [](const Vec3& a, const Vec3& b, const Vec3& way) {
        return std::vector<std::array<Vec3, 3>>{{a, a + way, b + way}, {a, b + way, b}};
    };
    // One goes through the box; the edge of the other, which stands in it, is bent.
    const Box box{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
    std::vector<std::array<Vec3, 3>> sweep =
        strip(Vec3(0.1, 2, -2), Vec3(0.1, 2, 2), Vec3(0, -4, 0));
    for (const auto& more : {strip(Vec3(0.5, -1, -2), Vec3(0.6, 0, 0), Vec3::Zero()),
                             strip(Vec3(0.6, 0, 0), Vec3(0.5, 1, 2), Vec3::Zero())}) {
        sweep.insert(sweep.end(), more.begin(), more.end());
    }
    const BladePaths found = blade_paths(sweep, box, 1e-9);
    REQUIRE(found.path.size() == 1);
    CHECK(std::abs(found.path[0].normal.x()) == Approx(1));
    CHECK(!found.has_folded);
}

namespace {

// x = off(y, z).
std::vector<std::array<Vec3, 3>> sweep_over(const std::function<double(double, double)>& off) {
    constexpr double kReach = 0.23;
    constexpr int kCount = 92, kRows = 8;
    const auto at = [&](int i, int j) -> Vec3 {
        const double y = kReach * (2.0 * i / kCount - 1), z = kReach * (2.0 * j / kRows - 1);
        return {off(y, z), y, z};
    };
    std::vector<std::array<Vec3, 3>> sweep;
    for (int i = 0; i < kCount; ++i) {
        for (int j = 0; j < kRows; ++j) {
            sweep.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            sweep.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return sweep;
}

}  // namespace

TEST_CASE("a path over a plane is found from which it leans by less than 80 degrees") {
    // Of waves as steep as 60 degrees as many normals lie across the plane as along it: beside a
    // whole number of waves the axes of them all stand askew.
    const double steep = GENERATE(1.2, 1.85, 2.0, 2.15, 5.0);
    const double count = GENERATE(20.4, 23.1, 25.8);
    const double phase = GENERATE(0.0, 0.3, 0.4);
    INFO(steep << " " << count << " " << phase);
    const auto off = [&](double y, double z) {
        return steep / count * std::sin(count * y + 0.3 * z + phase);
    };
    std::vector<std::array<Vec3, 3>> sweep = sweep_over(off);
    const bool comes_back = GENERATE(false, true);
    if (comes_back) {
        const std::vector<std::array<Vec3, 3>> there = sweep;
        for (const auto& t : there) sweep.push_back({t[0], t[2], t[1]});
    }
    const Box box{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
    const auto path = bent_path(sweep, box, 1e-4);
    REQUIRE(path);
    CHECK(path->first == 0);
    CHECK(std::abs(path->height(Vec3(off(0.1, 0.05), 0.1, 0.05))) < 0.02);
    // As one that looks for the least finds it: along x they lean by as much as they are steep.
    CHECK(path->steepest < 1.02 * std::sqrt(1 + (steep * steep) * 1.01));
}
