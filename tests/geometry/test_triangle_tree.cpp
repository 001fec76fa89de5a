// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_mesh.h"
#include "geometry/triangle_tree.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("a box lies between two points when the line from one to the other meets its faces") {
    const TriangleTree box(box_mesh(Vec3(-1, -2, -3), Vec3(1, 2, 3)));
    CHECK(box.lies_between({-5, 0.1, 0.2}, {5, 0.3, 0.1}));
    CHECK(box.lies_between({0, 0.1, 0.2}, {5, 0.3, 0.1}));            // from inside
    CHECK(box.lies_between({0.2, -5, 0.1}, {0.2, 5, 0.1}));           // along an axis
    CHECK_FALSE(box.lies_between({-5, 0.1, 0.2}, {-1.1, 0.3, 0.1}));  // ends before it
    CHECK_FALSE(box.lies_between({1.1, 0.1, 0.2}, {5, 0.3, 0.1}));    // begins behind it
    CHECK_FALSE(box.lies_between({-5, 2.1, 0}, {5, 2.1, 0}));         // passes by
    CHECK_FALSE(box.lies_between({-0.5, 0, 0}, {0.5, 0, 0}));         // inside, no face
    // A single face, along whose normal its box has no thickness.
    TriMesh single;
    single.position = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    single.triangle = {{0, 1, 2}};
    const TriangleTree face(single);
    CHECK(face.lies_between({0.2, 0.2, 0}, {0.3, 0.3, 2}));
    CHECK_FALSE(face.lies_between({0.9, 0.9, 0}, {0.9, 0.9, 2}));
}
