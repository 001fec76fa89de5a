// SPDX-License-Identifier: GPL-3.0-or-later
// What the repair makes of bodies that cross, touch and lie in each other.
#include "geometry/mesh_bodies.h"

#include "geometry/mesh_check.h"
#include "geometry/mesh_repair.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using fixtures::append;
using fixtures::box_mesh;
using fixtures::told;

namespace {

// Boxes in a row, each 0.2 into the next and a little aside of it.
TriMesh chain(const std::vector<int>& order) {
    TriMesh mesh;
    for (const int n : order) {
        const Vec3 low(n, 0.1 * (n % 3), 0.1 * (n % 2));
        append(mesh, box_mesh(low, low + Vec3(1.2, 1, 1)));
    }
    return mesh;
}

double chain_volume(int count) {
    double volume = 1.2 * count;
    for (int n = 0; n + 1 < count; ++n)
        volume -= 0.2 * (1 - 0.1 * std::abs((n + 1) % 3 - n % 3)) * 0.9;
    return volume;
}

TriMesh hollow_box() {
    TriMesh hollow = box_mesh({0, 0, 0}, {10, 10, 10});
    append(hollow, box_mesh({1, 1, 1}, {9, 9, 9}, true));
    return hollow;
}

// Six corners; inward.
TriMesh octahedron(const Vec3& middle, double reach, double up) {
    TriMesh mesh;
    mesh.position = {middle + Vec3(reach, 0, 0),  middle + Vec3(0, reach, 0),
                     middle + Vec3(-reach, 0, 0), middle + Vec3(0, -reach, 0),
                     middle + Vec3(0, 0, up),     middle + Vec3(0, 0, -reach)};
    for (int k = 0; k < 4; ++k) {
        mesh.triangle.push_back({4, (k + 1) % 4, k});
        mesh.triangle.push_back({5, k, (k + 1) % 4});
    }
    return mesh;
}

}  // namespace

TEST_CASE("a chain of crossing bodies is united in whatever order its links stand") {
    for (const std::vector<int>& order :
         {std::vector{0, 1, 2}, std::vector{1, 0, 2}, std::vector{2, 0, 1}}) {
        const Repair repair = repair_mesh(chain(order));
        CHECK(told(repair, "united 3 crossing bodies"));
        CHECK(signed_volume(repair.mesh) == Approx(chain_volume(3)));
        CHECK(check_mesh(repair.mesh).components == 1);
    }
    std::vector<int> many;
    for (int n = 0; n < 60; ++n) many.push_back((7 * n) % 60);
    const Repair repair = repair_mesh(chain(many));
    CHECK(told(repair, "united 60 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(chain_volume(60)));
    CHECK(check_mesh(repair.mesh).components == 1);
}

TEST_CASE("a rib that runs from wall to wall of a cavity becomes one with the walls") {
    TriMesh ribbed = hollow_box();
    append(ribbed, box_mesh({4, 4, 0.5}, {6, 6, 9.5}));
    const Repair repair = repair_mesh(ribbed);
    CHECK(told(repair, "united 2 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(1000 - 512 + 4 * 8));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());

    // Inside out, the whole of it.
    for (Corners& t : ribbed.triangle) std::swap(t[0], t[1]);
    const Repair turned = repair_mesh(ribbed);
    CHECK(told(turned, "inside out"));
    CHECK(signed_volume(turned.mesh) == Approx(1000 - 512 + 4 * 8));

    // A body that only stands on the cavity's floor.
    TriMesh standing = hollow_box();
    append(standing, box_mesh({4, 4, 1}, {6, 6, 5}));
    const Repair stands = repair_mesh(standing);
    CHECK(stands.account.empty());
    CHECK(signed_volume(stands.mesh) == Approx(488 + 16));

    // One that lies in the wall, flush with the cavity: there is nothing to add.
    TriMesh flush = hollow_box();
    append(flush, box_mesh({4, 4, 0.5}, {6, 6, 1}));
    CHECK(signed_volume(repair_mesh(flush).mesh) == Approx(488));
}

TEST_CASE("a cavity that touches the wall from within stays a cavity") {
    // It reaches the middle of the top face with one corner.
    TriMesh mesh = box_mesh({0, 0, 0}, {10, 10, 10});
    append(mesh, octahedron({6, 5, 5}, 3, 5));
    const double cavity = 2 * 9 * (3 + 5) / 3.0;
    const Repair repair = repair_mesh(mesh);
    CHECK(repair.account.empty());
    CHECK(signed_volume(repair.mesh) == Approx(1000 - cavity));

    for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
    const Repair turned = repair_mesh(mesh);
    CHECK(told(turned, "turned the whole surface"));
    CHECK(signed_volume(turned.mesh) == Approx(1000 - cavity));

    // An island in it counts, and what reaches through the wall is united.
    for (Corners& t : mesh.triangle) std::swap(t[0], t[1]);
    append(mesh, box_mesh({5.5, 4.5, 4.5}, {6.5, 5.5, 5.5}));
    CHECK(repair_mesh(mesh).account.empty());
    append(mesh, box_mesh({-1, 4, 4}, {1, 5, 5}));
    const Repair united = repair_mesh(mesh);
    CHECK(told(united, "united 2 crossing bodies"));
    CHECK(signed_volume(united.mesh) == Approx(1000 - cavity + 1 + 1));
}

TEST_CASE("an inside-out body half sunk into another is no cavity of it") {
    TriMesh mesh = box_mesh({0, 0, 0}, {2, 2, 2});
    append(mesh, box_mesh({0.5, 0.5, 1.5}, {1.5, 1.5, 2.5}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "turned 1 of 2 bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(8.5));
}

TEST_CASE("cavities that cross are one") {
    TriMesh mesh = box_mesh({0, 0, 0}, {10, 10, 10});
    append(mesh, box_mesh({1, 1, 1}, {6, 6, 6}, true));
    append(mesh, box_mesh({4, 4, 4}, {9, 9, 9}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "united 2 crossing cavities"));
    CHECK(signed_volume(repair.mesh) == Approx(1000 - 250 + 8));
    CHECK(check_mesh(repair.mesh).bounds_a_volume());

    // And stay so where the body crosses another.
    append(mesh, box_mesh({9.5, 4, 4}, {12, 6, 6}));
    CHECK(signed_volume(repair_mesh(mesh).mesh) == Approx(1000 - 250 + 8 + 8));
}

TEST_CASE("a mesh given twice, as two shells, is one body") {
    for (const bool inward : {false, true}) {
        TriMesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
        append(mesh, box_mesh({0, 0, 0}, {1, 2, 3}, inward));
        const Repair repair = repair_mesh(mesh);
        CHECK(told(repair, "united 2 crossing bodies: a volume of 6 m3"));
        CHECK(signed_volume(repair.mesh) == Approx(6));
        CHECK(check_mesh(repair.mesh).components == 1);
    }
}
