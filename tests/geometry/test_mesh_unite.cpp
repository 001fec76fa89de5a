// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_unite.h"

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
