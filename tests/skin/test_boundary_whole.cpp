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

// A ball, or a rod that lies askew, and how far out of it a place lies.
double out_of(bool is_ball, const Vec3& at) {
    if (is_ball) return at.norm() - 4.5;
    const Vec3 along = Vec3(2, 1, .6).normalized();
    const double far = std::abs(along.dot(at)) - 7;
    const double aside = at.cross(along).norm() - 3.1;
    return std::max(far, aside) < 0 ? std::max(far, aside)
                                    : std::hypot(std::max(far, 0.0), std::max(aside, 0.0));
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

TEST_CASE("where an edge of four faces is parted the picture goes on over what it is parted into") {
    const int kind = GENERATE(9, 54);
    const Aggregate matter = lumps(kind);
    TriMesh mesh = boundary_skin(matter).mesh;
    const auto texture_at = [](const Vec3& p) {
        return Vec2(p.x() + 0.5 * p.z(), p.y() - 0.7 * p.z());
    };
    for (const Vec3& p : mesh.position) mesh.uv.push_back(texture_at(p));
    mesh.triangle_uv = mesh.triangle;
    const NewLook look(mesh);
    const BoundarySkin skin = boundary_skin(matter, &look);
    const int faces = skin.mesh.triangle_polygon.back() + 1;
    REQUIRE(static_cast<int>(skin.mesh.triangle.size()) > 2 * faces);  // some are
    double worst = 0;
    for (std::size_t t = 0; t < skin.mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Vec3& place = skin.mount.reference[skin.mesh.triangle[t][k]];
            const Vec2& uv = skin.mesh.uv[skin.mesh.triangle_uv[t][k]];
            worst = std::max(worst, (uv - texture_at(place)).norm());
        }
    }
    CHECK(worst < 0.05);  // a new vertex lies off its edge by 0.02
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

TEST_CASE(
    "where matter breaks its boundary stays on the surface, and runs nowhere through itself") {
    const bool is_ball = GENERATE(true, false);
    const double roughness = GENERATE(0., .25);
    // Of the connections that are broken the share, or those across a plane.
    const double share = GENERATE(.003, .03, .3, 0.);
    CAPTURE(is_ball, roughness, share);
    Aggregate matter = test::make_shape([&](const Vec3& at) { return out_of(is_ball, at); },
                                        Vec3(-9, -9, -9), Vec3i::Constant(18), 1);
    const double whole = surface_area(boundary_skin(matter).mesh);
    std::mt19937 random(5);
    const Vec3 across = Vec3(1, .31, -.44).normalized();
    const auto is_over = [&](ParticleId p) {
        return across.dot(matter.particle_reference.at(p)) > .2;
    };
    for (ConnectionArrays& all : matter.connection) all.damage.assign(matter.particle_count(), 0);
    for (const Span& span : matter.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            const bool breaks = share > 0 ? random() < share * std::mt19937::max()
                                          : is_over(lower) != is_over(upper);
            if (!breaks) continue;
            matter.connection[span.direction].weight.set(lower, 0);
            matter.connection[span.direction].damage[lower] = 1;
        }
    }
    const BoundarySkin skin = boundary_skin(matter, nullptr, roughness);
    double farthest = 0, area = 0;
    for (std::size_t t = 0; t < skin.mesh.triangle.size(); ++t) {
        if (skin.mesh.triangle_material[t] == 1) continue;
        const auto& [a, b, c] = skin.mesh.triangle[t];
        const auto at = [&](int v) { return skin.mount.reference[v]; };
        area += .5 * (at(b) - at(a)).cross(at(c) - at(a)).norm();
        for (int v : {a, b, c}) farthest = std::max(farthest, out_of(is_ball, at(v)));
    }
    CHECK(farthest < (share == .3 ? .5 : .15));  // .3: rubble
    CHECK(area == Approx(whole).epsilon(.02));
    CHECK(signed_volume(skin.mesh) == Approx(matter.volume()).epsilon(.002));
    CHECK(test::is_closed(skin.mesh));
    CHECK(test::crossings(skin.mesh) == 0);
}
