// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_shells.h"

#include <algorithm>
#include <utility>

#include "geometry/mesh_edit.h"

namespace swage {

std::vector<Shell> split_shells(const TriMesh& mesh, const std::vector<int>& shell, int count) {
    std::vector<Shell> shells(count);
    std::vector<std::vector<std::size_t>> triangles(count);
    for (std::size_t t = 0; t < shell.size(); ++t) triangles[shell[t]].push_back(t);
    std::vector<int> place(mesh.position.size(), -1);
    for (int s = 0; s < count; ++s) {
        TriMesh& part = shells[s].mesh;
        const auto pick = [&](const auto& from, auto& to) {
            if (from.empty()) return;
            for (const std::size_t t : triangles[s]) to.push_back(from[t]);
        };
        pick(mesh.triangle, part.triangle);
        pick(mesh.triangle_uv, part.triangle_uv);
        pick(mesh.triangle_smooth, part.triangle_smooth);
        pick(mesh.triangle_polygon, part.triangle_polygon);
        pick(mesh.triangle_material, part.triangle_material);
        pick(mesh.triangle_part, part.triangle_part);
        std::vector<int> used;
        for (Corners& c : part.triangle)
            for (int& i : c) {
                if (place[i] < 0) {
                    place[i] = static_cast<int>(used.size());
                    used.push_back(i);
                }
                i = place[i];
            }
        for (const int i : used) {
            part.position.push_back(mesh.position[i]);
            if (!mesh.position_color.empty()) part.position_color.push_back(mesh.position_color[i]);
            place[i] = -1;
        }
        shells[s].box = box_of(part.position);
        shells[s].volume = signed_volume(part);
    }
    return shells;
}

TriMesh join_shells(const TriMesh& whole, const std::vector<const TriMesh*>& parts) {
    TriMesh mesh;
    mesh.uv = whole.uv;
    mesh.material = whole.material;
    mesh.part_name = whole.part_name;
    mesh.smooth_group_count = whole.smooth_group_count;
    for (const TriMesh* part : parts) {
        const int base = static_cast<int>(mesh.position.size());
        const auto add = [](const auto& from, auto& to) {
            to.insert(to.end(), from.begin(), from.end());
        };
        add(part->position, mesh.position);
        add(part->position_color, mesh.position_color);
        for (Corners c : part->triangle) {
            for (int& i : c) i += base;
            mesh.triangle.push_back(c);
        }
        add(part->triangle_uv, mesh.triangle_uv);
        add(part->triangle_smooth, mesh.triangle_smooth);
        add(part->triangle_polygon, mesh.triangle_polygon);
        add(part->triangle_material, mesh.triangle_material);
        add(part->triangle_part, mesh.triangle_part);
    }
    return mesh;
}

TriMesh dress_pieces(TriMesh pieces, const std::vector<int>& origin, const TriMesh& a,
                     const TriMesh& b, std::vector<Vec2>& uv) {
    const int in_a = static_cast<int>(a.triangle.size());
    if (!a.position_color.empty())
        pieces.position_color.assign(pieces.position.size(), Eigen::Vector3f::Ones());
    for (std::size_t t = 0; t < pieces.triangle.size(); ++t) {
        const TriMesh& from = origin[t] < in_a ? a : b;
        const int o = origin[t] < in_a ? origin[t] : origin[t] - in_a;
        if (!from.triangle_material.empty())
            pieces.triangle_material.push_back(from.triangle_material[o]);
        if (!from.triangle_part.empty()) pieces.triangle_part.push_back(from.triangle_part[o]);
        const Corners& c = from.triangle[o];
        const Vec3 &p0 = from.position[c[0]], &p1 = from.position[c[1]], &p2 = from.position[c[2]];
        const Vec3 normal = (p1 - p0).cross(p2 - p0);
        const double whole = normal.squaredNorm();
        Corners corner_uv = {-1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const int place = pieces.triangle[t][k];
            const Vec3& p = pieces.position[place];
            Vec3 share = Vec3(1, 1, 1) / 3;  // barycentric
            if (whole > 0)
                share =
                    Vec3((p2 - p1).cross(p - p1).dot(normal), (p0 - p2).cross(p - p2).dot(normal),
                         (p1 - p0).cross(p - p0).dot(normal)) /
                    whole;
            for (int j = 0; j < 3; ++j)
                if (p == from.position[c[j]]) share = Vec3::Unit(j);
            if (!pieces.position_color.empty())
                pieces.position_color[place] =
                    static_cast<float>(share[0]) * from.position_color[c[0]] +
                    static_cast<float>(share[1]) * from.position_color[c[1]] +
                    static_cast<float>(share[2]) * from.position_color[c[2]];
            if (from.triangle_uv.empty()) continue;
            const Corners& old = from.triangle_uv[o];
            for (int j = 0; j < 3; ++j)
                if (share[j] == 1) corner_uv[k] = old[j];
            if (corner_uv[k] < 0 && std::min({old[0], old[1], old[2]}) >= 0) {
                corner_uv[k] = static_cast<int>(uv.size());
                uv.push_back(share[0] * uv[old[0]] + share[1] * uv[old[1]] + share[2] * uv[old[2]]);
            }
        }
        if (!from.triangle_uv.empty()) pieces.triangle_uv.push_back(corner_uv);
    }
    return pieces;
}

void turn_over(Shell& shell) {
    for (std::size_t t = 0; t < shell.mesh.triangle.size(); ++t) flip_triangle(shell.mesh, t);
    shell.volume = -shell.volume;
    shell.tree.reset();
}

}  // namespace swage
