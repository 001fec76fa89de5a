// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a molded body's surface a load's box takes.
#include "geometry/make_shape.h"
#include "machines/machine.h"
#include "machines/region.h"
#include "mold/mold.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("of a ball a box takes its cap, whatever the cells and however they lie") {
    constexpr double kRadius = 0.5;
    const TriMesh mesh = make_shape("sphere", {{"diameter", 2 * kRadius}, {"division", 48}}).mesh;
    for (const double turned : {0.0, 0.6}) {
        for (const int across : {5, 8, 12}) {
            MoldSettings settings;
            settings.spacing = 2 * kRadius / across;
            const Aggregate ball = mold(mesh, Material{}, settings);
            const Pose world_from_work{turn_about(Vec3(1, 2, 2) / 3, turned), Vec3::Zero()};
            std::vector<Vec3> in_work;
            for (const Vec3& p : surface_positions(ball)) {
                in_work.push_back(world_from_work.inverse() * p);
            }
            for (const double high : {0.21, 0.34, 0.5, 0.62}) {
                const Box box{Vec3(kRadius - high, -1, -1), Vec3(1, 1, 1)};
                const SurfacePart region =
                    find_region(ball, world_from_work, in_work, Side::all, &box);
                double area = 0;
                for (std::size_t n = 0; n < region.point.size(); ++n) {
                    area += region.share[n] * ball.surface.area(region.point[n]);
                }
                INFO(turned << ' ' << across << ' ' << high);
                CHECK(area == Approx(2 * kPi * kRadius * high).epsilon(0.012));
            }
        }
    }
}
