// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box.h"

#include "geometry/box_mesh.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("boxes that share a face, an edge or a corner overlap, and others only if they do") {
    const Box one = {Vec3(0, 0, 0), Vec3(1, 2, 3)};
    CHECK(one.overlaps(one));
    CHECK(one.overlaps({Vec3(1, 0, 0), Vec3(2, 1, 1)}));
    CHECK(one.overlaps({Vec3(-1, -1, -1), Vec3(0, 0, 0)}));
    for (int axis = 0; axis < 3; ++axis) {
        for (const double way : {-3.01, 3.01}) {
            const Vec3 shift = way * Vec3::Unit(axis);
            const Box other = {one.low + shift, one.high + shift};
            CHECK_FALSE(one.overlaps(other));
            CHECK_FALSE(other.overlaps(one));
        }
    }
    CHECK_FALSE(one.overlaps(Box()));
}

TEST_CASE("a box contains its corners, and wider by more than nothing what is near them") {
    const Box box = {Vec3(-1, 0, 2), Vec3(1, 3, 4)};
    for (int c = 0; c < 8; ++c) {
        CHECK(box.contains(box.corner(c)));
        const Vec3 out = box.corner(c) + 0.01 * (box.corner(c) - box.center());
        CHECK_FALSE(box.contains(out));
        CHECK(box.widened(0.03).contains(out));
    }
    CHECK_FALSE(Box().contains(Vec3::Zero()));
}

TEST_CASE("a box that has grown by another contains both, and by an empty one is as it was") {
    Box box = {Vec3(0, 0, 0), Vec3(1, 1, 1)};
    box.grow(Box());
    CHECK(box.low == Vec3(0, 0, 0));
    CHECK(box.high == Vec3(1, 1, 1));
    box.grow(Box{Vec3(-1, 0.5, 0.5), Vec3(0.5, 0.5, 2)});
    CHECK(box.low == Vec3(-1, 0, 0));
    CHECK(box.high == Vec3(1, 1, 2));
}

TEST_CASE("a mesh is taken for a box where it fills the one around it, and only there") {
    const Box box{Vec3(1, 2, 3), Vec3(2, 4, 6)};
    TriMesh mesh = box_mesh(box);
    REQUIRE(box_it_is(mesh));
    CHECK(box_it_is(mesh)->high == box.high);
    TriMesh turned = mesh;
    for (Corners& t : turned.triangle) std::swap(t[0], t[1]);
    CHECK_FALSE(box_it_is(turned));
    TriMesh tetrahedron;  // of four of its corners
    for (const int c : {0, 3, 5, 6}) tetrahedron.position.push_back(box.corner(c));
    tetrahedron.triangle = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    CHECK_FALSE(box_it_is(tetrahedron));
    mesh.position.push_back(box.center());
    CHECK_FALSE(box_it_is(mesh));
    CHECK_FALSE(box_it_is(TriMesh()));
}
