// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/carried_insets.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/clip_mesh.h"
#include "geometry/edges.h"
#include "geometry/triangle_tree.h"
#include "mold/caps.h"
#include "skin/broken_skin.h"
#include "skin/cut_mesh.h"
#include "skin/divided_mesh.h"
#include "skin/settings.h"

namespace swage {

namespace {

constexpr double kReach = 0.1;       // [cells], of what lies on the body's surface
constexpr double kBeyond = 1;        // [cells], that what reaches out is left
constexpr double kOnSurface = 1e-3;  // [cells], that count as none

// By number, for each triangle: whether it lies on the surface of the body or outside.
std::vector<char> outer_triangles(const TriMesh& mesh, const TriMesh& body, double spacing) {
    const TriangleTree tree(body);
    const auto is_out = [&](const Vec3& p) {
        return tree.winding_number(p) < 0.5 || tree.distance(p) < kOnSurface * spacing;
    };
    std::vector<char> out(mesh.position.size()), outer(mesh.triangle.size());
    constexpr std::size_t kChunk = 64;
    parallel_each(out.size(), kChunk, [&](std::size_t v) { out[v] = is_out(mesh.position[v]); });
    parallel_each(outer.size(), kChunk, [&](std::size_t t) {
        const Corners& c = mesh.triangle[t];
        const auto& x = mesh.position;
        outer[t] = out[c[0]] && out[c[1]] && out[c[2]] && is_out((x[c[0]] + x[c[1]] + x[c[2]]) / 3);
    });
    return outer;
}

// Moves outer triangles out along their normals, and all others within their planes, as well as the
// vertices that they share allow.
void reach_out(const std::vector<char>& outer, double by, TriMesh& mesh) {
    struct Sum {
        Mat3 planes = Mat3::Zero();
        Vec3 way = Vec3::Zero();
    };
    std::vector<Sum> sum(mesh.position.size());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Vec3 twice = area_vector(mesh.position, mesh.triangle[t]);
        const double area = twice.norm();
        if (!(area > 0)) continue;
        for (int v : mesh.triangle[t]) {
            sum[v].planes += twice * twice.transpose() / area;
            if (outer[t]) sum[v].way += by * twice;
        }
    }
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (sum[v].way.isZero(0)) continue;
        constexpr double kFreely = 1e-6;  // along what no triangle says anything of
        const Mat3 planes = sum[v].planes + kFreely * sum[v].planes.trace() * Mat3::Identity();
        const Vec3 way = planes.llt().solve(sum[v].way);
        const double most = 2 * by;  // at corners sharper than a cube's
        mesh.position[v] += std::min(1.0, most / way.norm()) * way;
    }
}

TriMesh closed(const TriMesh& mesh, std::size_t number, std::vector<std::string>& findings) {
    const HoleCaps caps = caps_over_holes(mesh);
    if (caps.apex.empty()) return mesh;
    findings.push_back(
        fmt::format("the surface of inset {} was left open in {} place{} where it was cut or "
                    "broke, and is closed by cones",
                    number, caps.apex.size(), caps.apex.size() == 1 ? "" : "s"));
    return with_caps(mesh, caps);
}

}  // namespace

bool carries_insets(const SceneSpec& scene, std::size_t from_stage, bool is_molded) {
    if (scene.work_piece().inset.empty()) return false;
    for (std::size_t s = from_stage; s < scene.stage.size(); ++s) {
        const bool remolds = scene.stage[s].remold && !(is_molded && s == from_stage);
        if (remolds || !scene.stage[s].machine.blade.empty()) return true;
    }
    return false;
}

std::vector<CarriedInset> carry_insets(const std::vector<Inset>& insets,
                                       std::vector<SurfaceMaterial> looks, const TriMesh* body,
                                       const Aggregate& matter) {
    const double a = matter.lattice.spacing;
    Box box;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        box.grow(matter.particle_reference.at(p));
    }
    std::vector<CarriedInset> carried;
    for (const Inset& inset : insets) {
        CarriedInset& one = carried.emplace_back();
        one.mesh = divide_edges(clipped_to_box(inset.solid, box.widened(kBeyond * a)),
                                kLongestSkinEdge * a);
        if (body != nullptr) reach_out(outer_triangles(one.mesh, *body, a), kReach * a, one.mesh);
        one.mount = mount_mesh(one.mesh.position, matter, SkinKind::mount);
        one.position = one.mesh.position;
        one.look = std::move(looks.at(carried.size() - 1));
    }
    return carried;
}

void follow_insets(std::vector<CarriedInset>& insets, const Aggregate& matter) {
    for (CarriedInset& one : insets) skin_positions(one.mount, matter, one.position);
}

void hold_insets(std::vector<CarriedInset>& insets, const Aggregate& matter) {
    for (CarriedInset& one : insets) hold_places(one.mount, matter, one.position);
}

void cut_insets(std::vector<CarriedInset>& insets, const Aggregate& matter,
                const std::vector<std::array<Vec3, 3>>& sweep) {
    for (CarriedInset& one : insets) {
        const CutResult cut = cut_skin(one.mesh, one.position, one.mount, matter, sweep);
        one.is_torn = one.is_torn || cut.has_folded;
    }
}

Insides insides_now(const std::vector<CarriedInset>& insets) {
    Insides insides;
    for (const CarriedInset& one : insets) {
        TriMesh surface;
        surface.position = one.position;
        surface.triangle = one.mesh.triangle;
        insides.add(std::move(surface), one.look);
    }
    return insides;
}

std::vector<Inset> insets_now(const std::vector<CarriedInset>& insets, const Aggregate& matter,
                              std::vector<std::string>& findings) {
    std::vector<Inset> now;
    for (std::size_t n = 0; n < insets.size(); ++n) {
        const CarriedInset& one = insets[n];
        if (one.is_torn) {
            fail(ExitCode::stopped,
                 "cannot mold anew: a blade's path turns back over itself within inset {}, which "
                 "cannot be cut along it",
                 n + 1);
        }
        TriMesh mesh = one.mesh;
        const Mount* mount = &one.mount;
        BrokenSkin broken;
        if (is_broken(matter)) {
            broken = break_skin(one.mesh, one.mount, matter, 0, false);
            mesh = broken.mesh, mount = &broken.mount;
        }
        skin_positions(*mount, matter, mesh.position);
        now.push_back({closed(mesh, n + 1, findings), matter.inset[n]});
    }
    return now;
}

}  // namespace swage
