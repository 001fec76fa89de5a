// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/parted.h"
#include "matter/point_side.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("what lies beside a cut is carried by its own side alone, without losing its place") {
    const Vec3 normal =
        GENERATE(Vec3(1, 0, 0), Vec3(1, 0.4, 0.2), Vec3(0.3, 1, -0.7), Vec3(-1, 1, 0)).normalized();
    const double off = GENERATE(-0.04, 0.001, 0.03);
    Aggregate matter = make_block(7, 6, 5, 0.1, Material{});
    const Vec3 at(off, 0.013, 0.021);
    sever_plane(matter, at, normal);
    REQUIRE(find_pieces(matter).count == 2);
    std::size_t torn = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const PointCarriage carriage = carriage_on_side(matter, p);
        if (!is_parted(matter, p)) {
            CHECK(carriage.row == matter.surface.row(p));
            continue;
        }
        const Vec3 place = matter.surface_reference(p);
        if (std::abs(normal.dot(place - at)) < 1e-4 * 0.1) continue;
        ++torn;
        const bool is_above = normal.dot(place - at) > 0;
        const SurfacePoints::Carriers by = carriage.carriers();
        double sum = 0, sizes = 0;
        for (int c = 0; c < 8; ++c) {
            sum += by.weight[c];
            sizes += std::abs(by.weight[c]);
            if (by.weight[c] == 0) continue;
            const Vec3 x = matter.particle_reference.at(std::size_t(by.corner[c]));
            CHECK((normal.dot(x - at) > 0) == is_above);
        }
        CHECK(sum == Approx(1));
        CHECK(sizes < 8);  // by so much a force on it grows on particles
        CHECK(carriage.is_whole);
        CHECK((carriage.position(matter) - place).norm() < 1e-6);
    }
    CHECK(torn > 0);
}

TEST_CASE("sides outlast a second blade, and what only a crack parts lies half-way") {
    Aggregate matter = make_block(5, 3, 3, 0.1, Material{});  // a cell from -0.05 to 0.05
    const auto point = points_where(matter, [](const Vec3& x) {
        return x.y() > 0.1499 && x.z() < -0.1 && x.x() > 0 && x.x() < 0.05;
    });
    REQUIRE(point.size() == 1);  // at 0.025
    const auto p = static_cast<std::size_t>(point[0]);
    const auto is_left = [&] {
        const ParticleId by = carriage_on_side(matter, p).row[0];
        return matter.particle_reference.at(std::size_t(by)).x() < -0.1;
    };
    Aggregate cracked = matter;
    sever_plane(matter, Vec3(0.04, 0, 0), Vec3::UnitX());
    CHECK(is_left());
    sever_plane(matter, Vec3(0, 0, -0.14), Vec3::UnitZ());  // through the same cell
    CHECK(is_left());
    sever_plane(cracked, Vec3(0.04, 0, 0), Vec3::UnitX(), [](const Vec3&) { return true; });
    matter = cracked;
    CHECK_FALSE(is_left());
}
