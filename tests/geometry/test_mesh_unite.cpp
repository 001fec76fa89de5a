// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_unite.h"

#include <Eigen/Geometry>
#include <random>

#include "geometry/edges.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::append;
using test::box_mesh;

TEST_CASE("what two bodies have in common and their union are of the volume of both") {
    TriMesh hollow = box_mesh({0, 0, 0}, {10, 10, 10});
    append(hollow, box_mesh({1, 1, 1}, {9, 9, 9}, true));
    const TriMesh cube = box_mesh({0, 0, 0}, {2, 2, 2});
    struct Pair {
        TriMesh a, b;
        double common;
    };
    const std::vector<Pair> pairs = {
        {cube, box_mesh({0.5, 1.2, -1}, {5, 3, 1}), 1.5 * 0.8},  // cross
        {cube, box_mesh({0.5, 0.5, 0.5}, {1, 1, 1}), 0.125},     // one in the other
        {cube, box_mesh({0, 0, -1}, {2, 2, 1}), 4},              // flush on four sides
        {cube, box_mesh({0, 0, 0}, {2, 2, 2}), 8},               // the same
        {cube, box_mesh({2, 0, 0}, {3, 2, 2}), 0},               // side by side
        {cube, box_mesh({3, 0, 0}, {4, 2, 2}), 0},               // apart
        {hollow, box_mesh({4, 4, 0.5}, {6, 6, 9.5}), 4},         // through its cavity
    };
    for (std::size_t n = 0; n < pairs.size(); ++n) {
        INFO("pair " << n);
        const auto& [a, b, common] = pairs[n];
        for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
            TriMesh both, all;
            std::vector<int> origin;
            REQUIRE(intersect(*one, *other, both));
            CHECK(is_closed(both));
            CHECK(signed_volume(both) == Approx(common).margin(1e-12));
            REQUIRE(unite(*one, *other, all, origin));
            CHECK(signed_volume(all) == Approx(signed_volume(a) + signed_volume(b) - common));
        }
    }
}

TEST_CASE("a surface that crosses itself has nothing in common with another that is known") {
    TriMesh crossing = box_mesh({0, 0, 0}, {2, 2, 2});
    append(crossing, box_mesh({1, 1, 1}, {3, 3, 3}));
    TriMesh both;
    CHECK(!intersect(crossing, box_mesh({0.5, 0.5, 0.5}, {2.5, 2.5, 4}), both));
}

namespace {

// Between two places of the axis x.
TriMesh prism(int sides, double radius, double from, double to) {
    TriMesh mesh;
    mesh.position = {{from, 0, 0}, {to, 0, 0}};
    for (int s = 0; s < sides; ++s) {
        const double angle = 2 * kPi * s / sides;
        for (const double x : {from, to}) {
            mesh.position.push_back({x, radius * std::cos(angle), radius * std::sin(angle)});
        }
        const int a = 2 + 2 * s, b = 2 + 2 * ((s + 1) % sides);
        for (const Corners& t : {Corners{0, b, a}, Corners{1, a + 1, b + 1}, Corners{a, b, b + 1},
                                 Corners{a, b + 1, a + 1}}) {
            mesh.triangle.push_back(t);
        }
    }
    return mesh;
}

// Its walls are those of two prisms, its ends rings between them.
TriMesh tube_of(int sides, double outer, double inner) {
    TriMesh mesh = prism(sides, outer, -0.5, 0.5);
    const TriMesh bore = prism(sides, inner, -0.5, 0.5);
    const int count = static_cast<int>(mesh.position.size());
    append(mesh, bore);
    mesh.triangle.clear();
    for (int s = 0; s < sides; ++s) {
        const int a = 2 + 2 * s, b = 2 + 2 * ((s + 1) % sides);
        const auto quad = [&](int p, int q, int r, int t) {
            mesh.triangle.push_back({p, q, r});
            mesh.triangle.push_back({p, r, t});
        };
        quad(a, b, b + 1, a + 1);
        quad(count + a + 1, count + b + 1, count + b, count + a);
        quad(a, count + a, count + b, b);
        quad(a + 1, b + 1, count + b + 1, count + a + 1);
    }
    return mesh;
}

}  // namespace

TEST_CASE("a turned tube has in common with a rod of its own outer radius a ring of it",
          "[stress]") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int round = 0; round < 12; ++round) {
        INFO("round " << round);
        const int sides = 12 + 12 * (round % 2);
        const double end = 0.3 + 0.1 * any(random), middle = round % 3 > 0 ? -0.5 : 0;
        TriMesh tube = tube_of(sides, 0.1, 0.06), rod = prism(sides, 0.1, middle, end);
        REQUIRE(signed_volume(rod) > 0);
        const double expected = (end - middle) * signed_volume(tube);
        const Quat turn = Quat(any(random), any(random), any(random), any(random)).normalized();
        const Vec3 aside(any(random), any(random), any(random));
        for (TriMesh* mesh : {&tube, &rod}) {  // of which rounding parts what lay on each other
            for (Vec3& p : mesh->position) p = turn * p + aside;
        }
        for (const auto& [one, other] : {std::pair(&tube, &rod), std::pair(&rod, &tube)}) {
            TriMesh both;
            REQUIRE(intersect(*one, *other, both));
            CHECK(signed_volume(both) == Approx(expected).epsilon(1e-5));
        }
    }
}
