// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shadow_fit.h"

#include <cmath>

#include "render/studio.h"
#include "tests/catch.h"

using namespace swage;

namespace {

const Mat3 kLight = world_from_key_light({}, 0.6);

struct SeenPoint {
    Vec3 place;  // in the stage
    double depth;
};

// Ground seen from a little above it, about an eye at the origin that looks along -z.
std::vector<SeenPoint> ground_before_eye(double nearest, double farthest) {
    std::vector<SeenPoint> seen;
    for (int i = 0; i < 2000; ++i) {
        const double depth = nearest * std::pow(farthest / nearest, i / 1999.0);
        for (int k = -20; k <= 20; ++k) {
            seen.push_back({{0.02 * k * depth, -0.1 * nearest, -depth}, depth});
        }
    }
    return seen;
}

ShadowMaps maps_of(const std::vector<SeenPoint>& seen, const std::vector<Box>& casting) {
    ShadowFit fit(kLight, casting);
    for (const SeenPoint& p : seen) fit.see(kLight.transpose() * p.place, p.depth);
    return fit.maps();
}

}  // namespace

TEST_CASE("shadow maps hold what is seen at their depths, and in their seams", "[shadow fit]") {
    for (const double farthest : {2.0, 10.0, 40.0, 3000.0}) {
        const std::vector<SeenPoint> seen = ground_before_eye(1, farthest);
        const ShadowMaps maps = maps_of(seen, {{{-farthest, -0.1, -farthest}, {farthest, 0.1, 1}}});
        REQUIRE(!maps.map.empty());
        const int count = static_cast<int>(maps.map.size());
        for (const SeenPoint& p : seen) {
            const double part = std::log(p.depth / maps.nearest) * maps.per_log;
            CHECK(part > -1e-9);
            CHECK(part < count + 1e-9);
            for (const double off : {-0.99 * kSeam, 0.0, 0.99 * kSeam}) {
                const int i = std::clamp(static_cast<int>(std::floor(part + off)), 0, count - 1);
                const glm::dvec4 s =
                    maps.map[std::size_t(i)].map_from_stage * glm::dvec4(to_glm(p.place), 1);
                REQUIRE(std::min({s.x, s.y, s.z}) > 0);
                REQUIRE(std::max({s.x, s.y, s.z}) < 1);
            }
        }
        // Where much of depth is seen there are more, and what is near has a smaller one.
        CHECK((count > 1) == (farthest > 5));
        for (int i = 1; i < count; ++i) {
            CHECK(maps.map[std::size_t(i)].side > 1.5 * maps.map[std::size_t(i - 1)].side);
        }
    }
}

TEST_CASE("a shadow map is no larger than what casts shadows on what is seen", "[shadow fit]") {
    const Box ball{{-0.05, -0.05, -1.05}, {0.05, 0.05, -0.95}};
    Box another = ball;
    another.low.x() += 300, another.high.x() += 300;
    const std::vector<SeenPoint> seen = ground_before_eye(0.5, 500);
    const ShadowMaps alone = maps_of(seen, {ball});
    REQUIRE(alone.map.size() == 1);
    CHECK(alone.map[0].side < 0.3);
    const ShadowMaps both = maps_of(seen, {ball, another});
    CHECK(both.map[0].side < 0.3);
    CHECK(both.map[0].depth < 0.6);
    // Nearer to the lamp is less deep.
    const glm::dvec4 up = alone.map[0].map_from_stage * glm::dvec4(to_glm(Vec3(kLight.col(2))), 0);
    CHECK(up.z < 0);
}

TEST_CASE("without shadows there are no maps", "[shadow fit]") {
    CHECK(maps_of(ground_before_eye(1, 10), {}).map.empty());
    CHECK(maps_of({}, {{{-1, -1, -1}, {1, 1, 1}}}).map.empty());
    // What casts stands behind what is seen.
    CHECK(maps_of(ground_before_eye(1, 10), {{{-1, -5, -1}, {1, -4, 1}}}).map.empty());
}

TEST_CASE("a little more or less that is seen leaves a shadow map's texels where they were",
          "[shadow fit]") {
    const std::vector<Box> casting = {{{-0.5, -0.1, -2.5}, {0.5, 0.4, -1.5}}};
    int same = 0;
    const ShadowMaps first = maps_of(ground_before_eye(1, 4), casting);
    for (int i = 1; i <= 20; ++i) {
        std::vector<Box> moved = casting;
        moved[0].high.x() += 1e-4 * i;
        const ShadowMaps maps = maps_of(ground_before_eye(1, 4), moved);
        REQUIRE(maps.map.size() == 1);
        same += maps.map[0].lit.low.head<2>() == first.map[0].lit.low.head<2>() &&
                maps.map[0].side == first.map[0].side;
    }
    CHECK(same >= 15);
}
