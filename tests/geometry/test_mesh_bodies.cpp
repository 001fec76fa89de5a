// SPDX-License-Identifier: GPL-3.0-or-later
// What the repair makes of bodies that cross, touch and lie in each other.
#include "geometry/crease_angle.h"
#include "geometry/mesh_bodies.h"

#include <Eigen/Geometry>
#include <map>
#include <random>
#include <set>

#include "geometry/mesh_check.h"
#include "geometry/mesh_repair.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::append;
using test::box_mesh;
using test::told;

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

    // Given before the walls.
    TriMesh before = box_mesh({4, 4, 0.5}, {6, 6, 9.5});
    append(before, hollow_box());
    CHECK(signed_volume(repair_mesh(before).mesh) == Approx(1000 - 512 + 4 * 8));

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
    const Repair crossed = repair_mesh(mesh);
    CHECK(signed_volume(crossed.mesh) == Approx(1000 - 250 + 8 + 8));
    CHECK(told(crossed, "a volume of 2 m3 was counted more than once"));
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

TEST_CASE("a body inside another of the same sense does not count twice") {
    TriMesh mesh = box_mesh({0, 0, 0}, {3, 3, 3});
    append(mesh, box_mesh({1, 1, 1}, {2, 2, 2}));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "counted twice"));
    CHECK(signed_volume(repair.mesh) == Approx(27));
}

TEST_CASE("two bodies apart stay as they are; one inside out is turned") {
    TriMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    append(mesh, box_mesh({2, 0, 0}, {4, 1, 1}));
    CHECK(repair_mesh(mesh).account.empty());
    append(mesh, box_mesh({5, 0, 0}, {6, 1, 1}, true));
    const Repair repair = repair_mesh(mesh);
    CHECK(told(repair, "turned 1 of 3 bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(4));
}

TEST_CASE("crossing bodies are united to their true volume and keep their looks") {
    // Two crossing bars: neither has a vertex inside the other.
    TriMesh bars = box_mesh({-3, -0.5, -0.5}, {3, 0.5, 0.5});
    append(bars, box_mesh({-0.4, -3, -0.4}, {0.4, 3, 0.4}));
    bars.material.resize(2);
    bars.triangle_material.assign(12, 0);
    bars.triangle_material.resize(24, 1);
    for (const Vec3& p : bars.position) bars.uv.emplace_back(p.x(), p.y() + p.z());
    bars.triangle_uv = bars.triangle;
    const auto color_at = [](const Vec3& p) -> Vec3 { return (p + Vec3(3, 3, 3)) / 7; };
    for (const Vec3& p : bars.position) bars.position_color.push_back(color_at(p).cast<float>());
    const Repair repair = repair_mesh(bars);
    CHECK(told(repair, "united 2 crossing bodies"));
    CHECK(signed_volume(repair.mesh) == Approx(6 + 0.64 * 6 - 0.64));
    CHECK(check_mesh(repair.mesh).manifold);
    REQUIRE(repair.mesh.triangle_uv.size() == repair.mesh.triangle.size());
    REQUIRE(repair.mesh.triangle_material.size() == repair.mesh.triangle.size());
    for (std::size_t t = 0; t < repair.mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {  // a linear map stays linear through the cut
            const Vec3& p = repair.mesh.position[repair.mesh.triangle[t][k]];
            const Vec2& uv = repair.mesh.uv[repair.mesh.triangle_uv[t][k]];
            CHECK((uv - Vec2(p.x(), p.y() + p.z())).norm() < 1e-9);
        }
    REQUIRE(repair.mesh.position_color.size() == repair.mesh.position.size());
    for (std::size_t i = 0; i < repair.mesh.position.size(); ++i) {
        const Vec3 wanted = color_at(repair.mesh.position[i]);
        CHECK((repair.mesh.position_color[i].cast<double>() - wanted).norm() < 1e-6);
    }
}

TEST_CASE("normals of crossing bodies are where they are cut what they were there") {
    TriMesh bars = box_mesh({-3, -0.5, -0.5}, {3, 0.5, 0.5});
    append(bars, box_mesh({-0.4, -3, -0.4}, {0.4, 3, 0.4}));
    bars.triangle_smooth = bars.triangle;
    bars.smooth_group_count = static_cast<int>(bars.position.size());
    bars.smooth_normal = bars.position;  // linear in the place, and outward
    const TriMesh mesh = repair_mesh(bars).mesh;
    REQUIRE(mesh.triangle.size() > bars.triangle.size());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3& normal = mesh.smooth_normal.at(std::size_t(mesh.triangle_smooth[t][k]));
            CHECK((normal - mesh.position[mesh.triangle[t][k]]).norm() < 2e-3);
        }
}

TEST_CASE("too many bodies that cross are left as they are, for that reason") {
    // Rods that all go through one place.
    TriMesh star;
    for (int n = 0; n < 102; ++n) {
        TriMesh rod = box_mesh({-1, -0.002, -0.002}, {1, 0.002, 0.002});
        const double turn = kPi * n / 102, tilt = 0.3 * std::sin(7.0 * n);
        for (Vec3& p : rod.position)
            p = Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitY()) * p;
        append(star, rod);
    }
    const TriMesh before = star;
    std::vector<std::string> account;
    const auto reason = settle_bodies(star, kCreaseAngle, account);
    REQUIRE(reason);
    CHECK(*reason == "more than 5000 pairs of its parts cross or touch each other");
    CHECK(star.triangle == before.triangle);
    CHECK(account.empty());
}

TEST_CASE("bodies that share a face or a corner are left as they are") {
    // Welded: the inner wall is there twice, once each way.
    TriMesh pair = box_mesh({0, 0, 0}, {1, 1, 1});
    TriMesh next = box_mesh({1, 0, 0}, {2, 1, 1});
    const int match[8] = {1, -1, 3, -1, 5, -1, 7, -1};
    std::vector<int> place(8);
    for (int i = 0; i < 8; ++i) {
        place[i] = match[i] >= 0 ? match[i] : static_cast<int>(pair.position.size());
        if (match[i] < 0) pair.position.push_back(next.position[i]);
    }
    for (const Corners& t : next.triangle)
        pair.triangle.push_back({place[t[0]], place[t[1]], place[t[2]]});
    const Repair repair = repair_mesh(pair);
    CHECK(repair.account.empty());
    CHECK(signed_volume(repair.mesh) == Approx(2));
}
