// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/blade_edge.h"

#include "geometry/trimesh.h"
#include "machines/bodies.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

TEST_CASE("an edge that is a curve has as many points as it says, from along = 0 to 1") {
    BladeSpec blade;
    blade.edge = {{"2*along", "reach*along^2", "1 m"}};
    blade.points = 5;
    const std::vector<Vec3> edge = edge_of(blade, {{"reach", 3}});
    REQUIRE(edge.size() == 5);
    for (int n = 0; n < 5; ++n) {
        const double along = n / 4.0;
        CHECK((edge[n] - Vec3(2 * along, 3 * along * along, 1)).norm() < 1e-15);
    }
}

TEST_CASE("an edge that comes back to where it begins ends there to the bit") {
    BladeSpec blade;
    blade.edge = {{"cos(2*pi*along)", "0", "sin(2*pi*along)"}};
    blade.points = 7;
    const std::vector<Vec3> edge = edge_of(blade, {});
    REQUIRE(edge.size() == 7);
    CHECK(edge.front() == edge.back());
    // Forth and back is no way round.
    blade.points = 3;
    blade.edge = {{"abs(along - 0.5)", "0", "0"}};
    CHECK_THROWS_AS(edge_of(blade, {}), PlacedError);
}

TEST_CASE("the plate of an edge that goes all around is closed, and of its thickness everywhere") {
    std::vector<Vec3> edge;
    for (int n = 0; n < 48; ++n) {
        edge.push_back({std::cos(2 * kPi * n / 48), 0, std::sin(2 * kPi * n / 48)});
    }
    edge.push_back(edge.front());
    const TriMesh plate = blade_behind(edge, Vec3::UnitY(), 0.8, 0.1);
    CHECK(test::is_closed(plate));
    double low = 1, high = 1;
    for (const Vec3& p : plate.position) {
        const double radius = Vec2(p.x(), p.z()).norm();
        low = std::min(low, radius), high = std::max(high, radius);
    }
    CHECK(low == Approx(0.95));
    CHECK(high == Approx(1.05));
    // A ring that is ground to its edge on both sides, as polygons have it.
    const double ring = 48 * std::sin(kPi / 48) * std::cos(kPi / 48) * (1.05 * 1.05 - 0.95 * 0.95);
    CHECK(std::abs(signed_volume(plate)) == Approx(ring * (0.8 - 0.32 + 0.5 * 0.32)).epsilon(0.01));
}

TEST_CASE("where a blade goes first its plate is not, however far it comes back") {
    CHECK(farthest_forth({Vec3(0, -1, 0), Vec3(0, -2, 0), Vec3(0, 5, 0)}) == Vec3(0, -2, 0));
    CHECK(farthest_forth({Vec3(0, 1e-4, 0), Vec3(0, -2, 0), Vec3(0, 0, 0)}) == Vec3(0, -2, 0));
    CHECK(farthest_forth({Vec3::Zero(), Vec3::Zero()}) == Vec3::Zero());
}
