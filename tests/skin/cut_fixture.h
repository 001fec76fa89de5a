// SPDX-License-Identifier: GPL-3.0-or-later
// A bar of cells with a skin that blades cut.
#pragma once

#include <map>
#include <set>

#include "skin/cut_mesh.h"
#include "skin/new_look.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

namespace swage::test {

using Sweep = std::vector<std::array<Vec3, 3>>;

// A rectangle in the plane, `reach` wide to every side.
inline Sweep sweep_of(const Vec3& point, const Vec3& normal, double reach) {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u).normalized();
    const auto at = [&](double s, double t) -> Vec3 { return point + reach * (s * u + t * v); };
    return {{at(-1, -1), at(1, -1), at(1, 1)}, {at(-1, -1), at(1, 1), at(-1, 1)}};
}

// On both sides together.
inline std::size_t cap_triangles(const TriMesh& mesh) {
    std::size_t count = 0;
    for (const int material : mesh.triangle_material) {
        count += material >= 0 && is_cut_look(mesh.material[std::size_t(material)]);
    }
    return count;
}

// The surface of a grid of squares, closed: a box, or a tube with a square hole along x.
inline TriMesh box_mesh(const Vec3& half, const Vec3i& division, bool hollow) {
    TriMesh mesh;
    std::map<std::array<int, 3>, int> id;
    const auto vertex = [&](const Vec3i& at) {
        const auto [entry, fresh] = id.emplace(std::array<int, 3>{at[0], at[1], at[2]},
                                               static_cast<int>(mesh.position.size()));
        if (fresh) {
            mesh.position.push_back(half.cwiseProduct(
                2 * at.cast<double>().cwiseQuotient(division.cast<double>()) - Vec3::Ones()));
        }
        return entry->second;
    };
    const auto solid = [&](const Vec3i& c) {
        if ((c.array() < 0).any() || (c.array() >= division.array()).any()) return false;
        return !hollow || c[1] < division[1] / 3 || c[1] >= division[1] - division[1] / 3 ||
               c[2] < division[2] / 3 || c[2] >= division[2] - division[2] / 3;
    };
    for (int k = 0; k < division[2]; ++k)
        for (int j = 0; j < division[1]; ++j)
            for (int i = 0; i < division[0]; ++i) {
                const Vec3i cell(i, j, k);
                if (!solid(cell)) continue;
                for (int axis = 0; axis < 3; ++axis)
                    for (int end = 0; end < 2; ++end) {
                        const Vec3i way = (end ? 1 : -1) * Vec3i::Unit(axis);
                        if (solid(cell + way)) continue;
                        const Vec3i low = cell + end * Vec3i::Unit(axis);
                        const Vec3i u = Vec3i::Unit((axis + 1) % 3),
                                    v = Vec3i::Unit((axis + 2) % 3);
                        std::array<int, 4> q = {vertex(low), vertex(low + u), vertex(low + u + v),
                                                vertex(low + v)};
                        if (!end) std::swap(q[1], q[3]);
                        mesh.triangle.push_back({q[0], q[1], q[2]});
                        mesh.triangle.push_back({q[0], q[2], q[3]});
                    }
            }
    return mesh;
}

// Texture coordinates that are a linear function of the place, smoothing, parts, polygons.
inline void dress(TriMesh& mesh) {
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        Corners uv;
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.position[mesh.triangle[t][k]];
            uv[k] = static_cast<int>(mesh.uv.size());
            mesh.uv.push_back({p.x() + 2 * p.y(), p.z() - p.x()});
        }
        mesh.triangle_uv.push_back(uv);
        mesh.triangle_polygon.push_back(static_cast<int>(t / 2));
        mesh.triangle_part.push_back(0);
    }
    mesh.part_name = {"body"};
    smooth_by_crease_angle(mesh, 0.6);
}

inline void check_sound(const TriMesh& mesh, const std::vector<Vec3>& position) {
    CHECK(test::is_closed(mesh));
    std::set<Corners> seen;
    double least_area = 1e30;
    for (Corners t : mesh.triangle) {
        const Vec3 area = (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
        least_area = std::min(least_area, area.norm());
        std::sort(t.begin(), t.end());
        CHECK(seen.insert(t).second);
    }
    CHECK(least_area > 1e-9);
}

// The parts of the surface as meshes.
inline std::vector<TriMesh> parts_of(const TriMesh& mesh) {
    const Components components = surface_components(mesh);
    std::vector<TriMesh> parts(components.count);
    for (TriMesh& part : parts) part.position = mesh.position;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        parts[components.triangle_component[t]].triangle.push_back(mesh.triangle[t]);
    }
    return parts;
}

struct Fixture {
    Aggregate matter;
    TriMesh mesh;
    Mount mount;
    std::vector<Vec3> position;

    // 0.3 x 0.3 across.
    explicit Fixture(TriMesh made, int cells_along = 20)
        : matter(test::make_block(cells_along, 6, 6, 0.05, Material{})), mesh(std::move(made)) {
        dress(mesh);
        mount = mount_mesh(mesh.position, matter, SkinKind::mount);
        follow();
    }
    void follow() { skin_positions(mount, matter, position); }
    // Round an axis along z, by 1.2 rad in all.
    void bend() {
        test::deform(matter, [](const Vec3& p) -> Vec3 {
            const double t = 1.2 * p.x(), r = 1 / 1.2 - p.y();
            return {r * std::sin(t), 1 / 1.2 - r * std::cos(t), p.z()};
        });
        follow();
    }
    CutResult cut(const Sweep& sweep, const Insides& insides = {}) {
        const CutResult result = cut_skin(mesh, position, mount, matter, sweep, insides);
        follow();
        return result;
    }
};

inline TriMesh bar(bool hollow = false) { return box_mesh({.5, .15, .15}, {24, 9, 9}, hollow); }

}  // namespace swage::test
