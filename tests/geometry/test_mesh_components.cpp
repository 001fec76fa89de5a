// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "geometry/mesh_check.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using swage::test::box_mesh;

namespace {

// Of boxes, with one position for each place.
TriMesh welded(const std::vector<TriMesh>& parts) {
    TriMesh mesh;
    for (const TriMesh& part : parts) {
        std::vector<int> place;
        for (const Vec3& p : part.position) {
            auto at = std::find(mesh.position.begin(), mesh.position.end(), p);
            if (at == mesh.position.end()) at = mesh.position.insert(at, p);
            place.push_back(static_cast<int>(at - mesh.position.begin()));
        }
        for (const Corners& t : part.triangle) {
            mesh.triangle.push_back({place[t[0]], place[t[1]], place[t[2]]});
        }
    }
    return mesh;
}

TriMesh box_at(double x, double y, double z) {
    const Vec3 low(x, y, z);
    return box_mesh(low, low + Vec3::Ones());
}

}  // namespace

TEST_CASE("closed surfaces that touch at an edge or a vertex are counted each") {
    CHECK(check_mesh(welded({box_at(0, 0, 0), box_at(1, 1, 0)})).components == 2);
    CHECK(check_mesh(welded({box_at(0, 0, 0), box_at(1, 1, 1)})).components == 2);
    CHECK(check_mesh(welded({box_at(0, 0, 0), box_at(1, 1, 0), box_at(5, 5, 5)})).components == 3);
    CHECK(check_mesh(welded({box_at(0, 0, 0), box_at(3, 0, 0)})).components == 2);
}

TEST_CASE(
    "open surfaces that share an edge are one, as is a box of which a part or all is given twice") {
    TriMesh patched = welded({box_at(0, 0, 0)});
    patched.triangle.push_back(patched.triangle[0]);
    CHECK(check_mesh(patched).components == 1);
    CHECK(check_mesh(welded({box_at(0, 0, 0), box_at(0, 0, 0)})).components == 1);
    TriMesh sheets;
    sheets.position = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    sheets.triangle = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    CHECK(check_mesh(sheets).components == 1);
}
