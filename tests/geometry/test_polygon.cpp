// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/polygon.h"

#include <algorithm>

#include "geometry/mesh_read.h"
#include "geometry/shown_color.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("the halves of a quad turn as it does, fill it and meet at the diagonal named") {
    const std::array<Vec3, 4> p = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(2, 2, 0), Vec3(0, 1, 0)};
    for (const Diagonal by : {Diagonal::first, Diagonal::second}) {
        const auto both = halves({0, 1, 2, 3}, by);
        double area = 0;
        for (const Corners& t : both) {
            const double own = 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z();
            CHECK(own > 0);
            area += own;
            for (int end : {0, 2}) {
                const int corner = by == Diagonal::first ? end : end + 1;
                CHECK(std::count(t.begin(), t.end(), corner) == 1);
            }
        }
        CHECK(area == Approx(4));
    }
}

TEST_CASE("a quad with a corner that points in is cut so that both halves lie in it") {
    const std::vector<Vec3> p = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0, 2, 0)};
    std::vector<Corners> triangle;
    CHECK(cut_polygon(p, triangle));
    REQUIRE(triangle.size() == 2);
    for (const Corners& t : triangle) {
        CHECK((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z() > 0);
    }
}

TEST_CASE(
    "a polygon with a hole, which its outline goes to and back from, is cut without the hole") {
    const std::vector<Vec3> p = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                                 {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
    std::vector<Corners> triangle;
    CHECK(cut_polygon(p, triangle));
    CHECK(triangle.size() == 8);
    double area = 0;
    for (const Corners& t : triangle) {
        const double own = 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z();
        CHECK(own >= 0);
        area += own;
    }
    CHECK(area == Approx(8));
}

TEST_CASE("a polygon that comes back to its first corner has that once") {
    const Scratch scratch;
    const TriMesh mesh = read_mesh(scratch.write(
        "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 1\nf 1 1 4 3 3 2 1 1\n"));
    REQUIRE(mesh.triangle.size() == 4);
    for (const Corners& t : mesh.triangle) CHECK(area_vector(mesh.position, t).norm() == 1);
}

TEST_CASE("places have colours of their own where no two faces show them otherwise") {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 2}};
    mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_material = {0, 1};
    mesh.material.resize(2);
    CHECK(colors_of_positions(mesh));
    mesh.material[1].color = Vec3(0.1, 0.2, 0.3);
    CHECK_FALSE(colors_of_positions(mesh));
}

TEST_CASE("triangles of a polygon are joined again where their corners look alike, else not") {
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_polygon = {0, 0};
    mesh.triangle_smooth = mesh.triangle_uv = mesh.triangle;
    mesh.smooth_group_count = 5;
    mesh.uv.resize(5);
    CHECK(rejoin_polygons(mesh).count() == 1);
    TriMesh other = mesh;
    other.triangle_smooth[1][0] = 4;
    CHECK(rejoin_polygons(other).count() == 2);
    other = mesh;
    other.triangle_uv[1][1] = 4;
    CHECK(rejoin_polygons(other).count() == 2);
    other = mesh;
    other.triangle_material = {0, 1};
    CHECK(rejoin_polygons(other).count() == 2);
}
