// SPDX-License-Identifier: GPL-3.0-or-later
// That a boundary is the surface of a body, also where its parts are hardly wider than cells.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/catch.h"
#include "tests/shared/boundary.h"
#include "tests/shared/crossings.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

// A ball of bumps and arms about two cells wide, some of which come off it.
Aggregate lumps(int kind) {
    const double turn = 0.37 * kind;
    const Quat pose(Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()));
    return test::make_shape(
        [=](const Vec3& at) {
            const Vec3 p = 1.1 * (pose * at);
            const double bump = std::sin(p.x() + turn) * std::cos(p.y()) +
                                std::sin(p.y() + 2 * turn) * std::cos(p.z()) +
                                std::sin(p.z() + 3 * turn) * std::cos(p.x());
            return at.norm() - 4 - 1.5 * bump;
        },
        Vec3::Constant(-9), Vec3i::Constant(18), 1.0);
}

// Those that hold less than a tenth of a cell, but for bodies of their own.
int small_shells(const BoundarySkin& skin, const Aggregate& matter) {
    const TriMesh& mesh = skin.mesh;
    const Pieces pieces = find_pieces(matter);
    const Components shells = surface_components(mesh);
    std::vector<double> volume(shells.count, 0.0), most(pieces.count, 0.0);
    std::vector<int> piece(shells.count);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        const int shell = shells.triangle_component[t];
        volume[shell] += mesh.position[a].dot(mesh.position[b].cross(mesh.position[c])) / 6;
        const auto corners = matter.lattice.cell_corners(skin.mount.cell[a]);
        piece[shell] = pieces.particle_piece[corners[0]];
    }
    for (int s = 0; s < shells.count; ++s) {
        most[piece[s]] = std::max(most[piece[s]], volume[s]);
    }
    int small = 0;
    for (int s = 0; s < shells.count; ++s) {
        small +=
            std::abs(volume[s]) < 0.1 * matter.lattice.cell_volume() && volume[s] < most[piece[s]];
    }
    return small;
}

}  // namespace

TEST_CASE("no edge of a boundary has four faces, and none is open") {
    const int kind = GENERATE(9, 36, 52, 54);
    const Aggregate matter = lumps(kind);
    CAPTURE(kind);
    CHECK(test::is_closed(boundary_skin(matter).mesh));
}

TEST_CASE("a boundary has no shell that holds less than a voxel") {
    const int kind = GENERATE(9, 26, 38, 54);
    const Aggregate matter = lumps(kind);
    CAPTURE(kind);
    CHECK(small_shells(boundary_skin(matter), matter) == 0);
}

TEST_CASE("a boundary does not run through itself, and encloses its matter's volume") {
    const int kind = GENERATE(0, 3, 9);
    CAPTURE(kind);
    const Aggregate matter = lumps(kind);
    const TriMesh mesh = boundary_skin(matter).mesh;
    CHECK(test::crossings(mesh) == 0);
    CHECK(signed_volume(mesh) == Approx(matter.volume()).epsilon(0.02));
}

TEST_CASE("breaks of single connections here and there have two faces an edge") {
    std::mt19937 random(GENERATE(1, 2, 3));
    Aggregate block = test::make_block(6, 6, 6, 1, Material{});
    for (int axis = 0; axis < 3; ++axis) {
        for (int layer = -2; layer < 2; ++layer) {
            test::sever_plane(block, (layer + .5) * Vec3::Unit(axis), Vec3::Unit(axis),
                              [&](const Vec3& middle) {
                                  return middle.cwiseAbs().maxCoeff() < 2.9 && random() % 20 == 0;
                              });
        }
    }
    const TriMesh mesh = boundary_skin(block).mesh;
    CHECK(surface_components(mesh).count > 5);
    CHECK(test::is_closed(mesh));
}
