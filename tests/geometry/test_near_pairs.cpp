// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "geometry/near_pairs.h"
#include "tests/catch.h"
#include "tests/shared/sphere_pairs.h"

using namespace swage;

namespace {

std::vector<NearPair> by_trying_all(const std::vector<Vec3>& point, const std::vector<Box>& box) {
    std::vector<NearPair> pair;
    for (int p = 0; p < static_cast<int>(point.size()); ++p) {
        for (int b = 0; b < static_cast<int>(box.size()); ++b) {
            if ((point[p].array() >= box[b].low.array()).all() &&
                (point[p].array() <= box[b].high.array()).all()) {
                pair.push_back({p, b});
            }
        }
    }
    return pair;
}

}  // namespace

TEST_CASE("grid and trees of spheres find all pairs of random scenes, in one order") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0, 1);
    const auto place = [&](double size) -> Vec3 {
        return size * Vec3(any(random), any(random), any(random));
    };
    for (int scene = 0; scene < 60; ++scene) {
        const double flat = scene % 3 == 1 ? 1e-3 : 1, spread = scene % 4 == 3 ? 20 : 1;
        std::vector<Vec3> point(any(random) * 400);
        for (Vec3& p : point) p = place(1).cwiseProduct(Vec3(1, flat, spread));
        if (scene % 7 == 2) point.resize(point.size() + 30, Vec3(0.5, 0.5 * flat, 0.5));
        std::vector<Box> box(any(random) * 300);
        for (Box& b : box) {
            const Vec3 at = place(1).cwiseProduct(Vec3(1, flat, spread));
            const double size = any(random) < 0.02 ? 2 : 0.1;
            b.grow(at);
            b.grow(at + place(size));
        }
        if (!box.empty() && scene % 5 == 4) box[0].high.x() = std::nan("");
        const auto wanted = by_trying_all(point, box);
        INFO("scene " << scene << ", pairs " << wanted.size());
        CHECK(near_pairs(point, box) == wanted);
        CHECK(test::near_pairs_by_spheres(point, box) == wanted);
    }
}
