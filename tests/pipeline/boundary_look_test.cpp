// SPDX-License-Identifier: GPL-3.0-or-later
// A boundary of the calf, whose texture has many charts and whose legs and ears are thin.
#include <algorithm>
#include <cmath>

#include "geometry/mesh_read.h"
#include "mold/mold.h"
#include "skin/boundary.h"
#include "tests/catch.h"
#include "tests/shared/crossings.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

TriMesh calf() { return read_mesh(SWAGE_SOURCE_DIR "/assets/meshes/calf.obj"); }

Aggregate molded(const TriMesh& mesh, int across) {
    MoldSettings settings;
    settings.across = across;
    return mold(mesh, Material{}, settings);
}

// Of the area, what has less than a third of the texture that most has a length.
double squashed_share(const TriMesh& mesh) {
    std::vector<double> scale, area;
    double all = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners& uv = mesh.triangle_uv[t];
        const Vec2 u = mesh.uv[uv[1]] - mesh.uv[uv[0]], v = mesh.uv[uv[2]] - mesh.uv[uv[0]];
        area.push_back(area_vector(mesh.position, mesh.triangle[t]).norm() / 2);
        scale.push_back(std::sqrt(std::abs(u.x() * v.y() - u.y() * v.x()) / 2 / area.back()));
        all += area.back();
    }
    std::vector<double> sorted = scale;
    std::sort(sorted.begin(), sorted.end());
    const double most = sorted[sorted.size() / 2];
    double squashed = 0;
    for (std::size_t t = 0; t < scale.size(); ++t) {
        if (scale[t] < most / 3) squashed += area[t];
    }
    return squashed / all;
}

}  // namespace

TEST_CASE("a boundary of the calf has two faces an edge and does not run through itself") {
    const int across = GENERATE(5, 7, 9);
    CAPTURE(across);
    const Aggregate matter = molded(calf(), across);
    const TriMesh mesh = boundary_skin(matter).mesh;
    CHECK(test::is_closed(mesh));
    CHECK(surface_components(mesh).count == 1);
    CHECK(test::crossings(mesh) == 0);
    CHECK(signed_volume(mesh) == Approx(matter.volume()).epsilon(0.005));
}

TEST_CASE("next to nothing of a boundary has a squashed texture where the charts end") {
    const TriMesh mesh = calf();
    const NewLook look(mesh);
    CHECK(squashed_share(boundary_skin(molded(mesh, 12), &look).mesh) < 0.001);
}
