// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/surface_match.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "skin/new_look.h"

namespace swage {

namespace {

constexpr std::size_t kAsked = 400;  // triangles of a shell, about, that are looked for

using Matches = std::vector<TriangleTree::Nearest>;

// How far the points lie from the surface, summed.
double find_nearest(const std::vector<Vec3>& point, const TriMesh& surface, Matches& nearest) {
    const TriangleTree tree(surface);
    nearest.resize(point.size());
    parallel_each(point.size(), 256, [&](std::size_t i) { nearest[i] = tree.nearest(point[i]); });
    double sum = 0;
    for (std::size_t i = 0; i < point.size(); ++i) {
        sum += (place_on(nearest[i], surface.triangle, surface.position) - point[i]).norm();
    }
    return sum;
}

TriMesh shape_at(const TriMesh& mesh, const std::vector<Vec3>& position) {
    TriMesh shape;
    shape.triangle = mesh.triangle;
    shape.position = position;
    return shape;
}

bool is_new_face(const TriMesh& mesh, std::size_t triangle) {
    if (mesh.triangle_material.empty()) return false;
    const auto look = static_cast<std::size_t>(mesh.triangle_material[triangle]);
    return look < mesh.material.size() && is_cut_look(mesh.material[look]);
}

}  // namespace

Vec3 place_on(const TriangleTree::Nearest& nearest, const std::vector<Corners>& triangle,
              const std::vector<Vec3>& position) {
    const Corners& corner = triangle.at(static_cast<std::size_t>(nearest.triangle));
    return nearest.weight[0] * position[corner[0]] + nearest.weight[1] * position[corner[1]] +
           nearest.weight[2] * position[corner[2]];
}

std::vector<TriangleTree::Nearest> match_surface(const std::vector<Vec3>& mounted,
                                                 const std::vector<Vec3>& here,
                                                 const TriMesh& other,
                                                 const std::vector<Vec3>& there) {
    Matches nearest, found;
    double least = find_nearest(mounted, other, nearest);
    const auto try_also = [&](const std::vector<Vec3>& point, const TriMesh& surface) {
        if (least == 0) return;
        const double sum = find_nearest(point, surface, found);
        if (!(sum < least)) return;
        least = sum;
        nearest.swap(found);
    };
    try_also(here, other);
    try_also(mounted, shape_at(other, there));
    return nearest;
}

std::vector<int> parent_shells(const TriMesh& now, const std::vector<Vec3>& here,
                               const Components& now_shells, const TriMesh& other,
                               const std::vector<Vec3>& there, const Components& other_shells) {
    const auto count = static_cast<std::size_t>(now_shells.count);
    std::vector<int> parent(count, 0);
    if (other_shells.count < 2) return parent;
    std::vector<std::vector<int>> old_faces(count), new_faces(count);
    for (std::size_t t = 0; t < now.triangle.size(); ++t) {
        auto& faces = is_new_face(now, t) ? new_faces : old_faces;
        faces[std::size_t(now_shells.triangle_component[t])].push_back(static_cast<int>(t));
    }
    std::vector<Vec3> mounted_middle, middle_here;
    std::vector<std::pair<std::size_t, double>> whose;  // shell and weight
    for (std::size_t s = 0; s < count; ++s) {
        const std::vector<int>& face = old_faces[s].empty() ? new_faces[s] : old_faces[s];
        const std::size_t step = face.size() / kAsked + 1;
        for (std::size_t n = 0; n < face.size(); n += step) {
            const Corners& c = now.triangle[std::size_t(face[n])];
            const auto middle = [&](const std::vector<Vec3>& at) {
                return Vec3((at[c[0]] + at[c[1]] + at[c[2]]) / 3);
            };
            mounted_middle.push_back(middle(now.position));
            middle_here.push_back(middle(here));
            whose.push_back({s, area_vector(now.position, c).norm()});
        }
    }
    const Matches nearest = match_surface(mounted_middle, middle_here, other, there);
    std::vector<std::map<int, double>> votes(count);
    for (std::size_t n = 0; n < nearest.size(); ++n) {
        const auto triangle = static_cast<std::size_t>(nearest[n].triangle);
        votes[whose[n].first][other_shells.triangle_component[triangle]] += whose[n].second;
    }
    for (std::size_t s = 0; s < count; ++s) {
        const auto most =
            std::max_element(votes[s].begin(), votes[s].end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        if (most != votes[s].end()) parent[s] = most->first;
    }
    return parent;
}

std::vector<Vec3> carried_places(const TriMesh& now, const std::vector<Vec3>& here,
                                 const TriMesh& other, const std::vector<Vec3>& there) {
    std::vector<Vec3> carried = here;
    if (now.triangle.empty() || other.triangle.empty()) return carried;
    const Components own = surface_components(now), others = surface_components(other);
    const std::vector<int> parent = parent_shells(now, here, own, other, there, others),
                           child = parent_shells(other, there, others, now, here, own);
    // Of each shell those that it comes of or that come of it.
    std::vector<std::vector<int>> kin(std::size_t(own.count));
    for (std::size_t s = 0; s < kin.size(); ++s) kin[s].push_back(parent[s]);
    for (std::size_t o = 0; o < child.size(); ++o) {
        std::vector<int>& of = kin[std::size_t(child[o])];
        if (of.front() != static_cast<int>(o)) of.push_back(static_cast<int>(o));
    }
    for (std::vector<int>& one : kin) std::sort(one.begin(), one.end());
    // Shells with the same kin look for their places together.
    std::map<std::vector<int>, std::vector<int>> vertices;
    std::vector<char> is_seen(now.position.size(), 0);
    for (std::size_t t = 0; t < now.triangle.size(); ++t) {
        for (const int v : now.triangle[t]) {
            if (std::exchange(is_seen[std::size_t(v)], 1) != 0) continue;
            vertices[kin[std::size_t(own.triangle_component[t])]].push_back(v);
        }
    }
    for (const auto& [shells, vertex] : vertices) {
        TriMesh part;
        part.position = other.position;
        for (std::size_t t = 0; t < other.triangle.size(); ++t) {
            const int shell = others.triangle_component[t];
            if (std::binary_search(shells.begin(), shells.end(), shell)) {
                part.triangle.push_back(other.triangle[t]);
            }
        }
        std::vector<Vec3> mounted, at;
        for (const int v : vertex) {
            mounted.push_back(now.position[std::size_t(v)]);
            at.push_back(here[std::size_t(v)]);
        }
        const Matches match = match_surface(mounted, at, part, there);
        for (std::size_t n = 0; n < vertex.size(); ++n) {
            carried[std::size_t(vertex[n])] = place_on(match[n], part.triangle, there);
        }
    }
    return carried;
}

}  // namespace swage
