// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: corner angles as normal weights, G. Thuermer and C. Wuethrich, "Computing vertex
// normals from polygonal facets", 1998.
#include "geometry/trimesh.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 8192;  // triangles

template <typename Term>
double sum_over_triangles(const TriMesh& mesh, const Term& term) {
    return ordered_sum_of(mesh.triangle.size(), kChunk,
                          [&](std::size_t t) { return term(mesh.triangle[t]); });
}

// Corners are joined across an edge when its two faces run along it in opposite directions (they
// agree on the outside) and are smooth(one, other).
template <typename Smooth>
void smooth_across_edges(TriMesh& mesh, const Smooth& smooth) {
    const std::size_t count = mesh.triangle.size();
    DisjointSets corners(3 * count);
    const auto join = [&](const EdgeUse& a, const EdgeUse& b) {
        if (a.forward == b.forward || !smooth(a.triangle, b.triangle)) return;
        corners.unite(3 * a.triangle + a.side, 3 * b.triangle + (b.side + 1) % 3);
        corners.unite(3 * a.triangle + (a.side + 1) % 3, 3 * b.triangle + b.side);
    };
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        // All pairs; where many faces share an edge, each with its next, to stay linear.
        const std::size_t reach = uses.size() <= 8 ? uses.size() : 2;
        for (std::size_t i = 0; i < uses.size(); ++i)
            for (std::size_t j = i + 1; j < std::min(uses.size(), i + reach); ++j)
                join(uses[i], uses[j]);
    });
    std::vector<int> group;
    mesh.smooth_group_count = corners.number_sets(group);
    mesh.smooth_normal.clear();
    mesh.triangle_smooth.resize(count);
    for (std::size_t t = 0; t < count; ++t)
        mesh.triangle_smooth[t] = {group[3 * t], group[3 * t + 1], group[3 * t + 2]};
}

}  // namespace

TriMesh::TriMesh() = default;
TriMesh::~TriMesh() = default;
TriMesh::TriMesh(const TriMesh&) = default;
TriMesh::TriMesh(TriMesh&&) noexcept = default;
TriMesh& TriMesh::operator=(const TriMesh&) = default;
TriMesh& TriMesh::operator=(TriMesh&&) noexcept = default;

double signed_volume(const TriMesh& mesh) {
    if (mesh.triangle.empty()) return 0;
    const Vec3 center = box_of(mesh.position).center();
    return sum_over_triangles(mesh, [&](const Corners& t) {
        const Vec3 a = mesh.position[t[0]] - center;
        const Vec3 b = mesh.position[t[1]] - center;
        const Vec3 c = mesh.position[t[2]] - center;
        return a.dot(b.cross(c)) / 6;
    });
}

double surface_area(const TriMesh& mesh) {
    return sum_over_triangles(
        mesh, [&](const Corners& t) { return 0.5 * area_vector(mesh.position, t).norm(); });
}

std::vector<EdgeUse> edge_uses(const std::vector<Corners>& triangle, std::size_t position_count) {
    // Counting sort by the lower position, then a short sort within each.
    std::vector<std::size_t> first(position_count + 1, 0);
    for (const Corners& t : triangle)
        for (int side = 0; side < 3; ++side) {
            const int a = t[side], b = t[(side + 1) % 3];
            if (a != b) ++first[std::min(a, b) + 1];
        }
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<EdgeUse> uses(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < triangle.size(); ++t)
        for (int side = 0; side < 3; ++side) {
            const int a = triangle[t][side], b = triangle[t][(side + 1) % 3];
            if (a == b) continue;
            uses[next[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), static_cast<int>(t),
                                            side, a < b};
        }
    for (std::size_t i = 0; i < position_count; ++i)
        std::sort(uses.begin() + first[i], uses.begin() + first[i + 1],
                  [](const EdgeUse& x, const EdgeUse& y) {
                      if (x.high != y.high) return x.high < y.high;
                      return x.triangle != y.triangle ? x.triangle < y.triangle : x.side < y.side;
                  });
    return uses;
}

Components surface_components(const TriMesh& mesh) {
    DisjointSets sets(mesh.position.size());
    for (const Corners& t : mesh.triangle) {
        sets.unite(t[0], t[1]);
        sets.unite(t[0], t[2]);
    }
    // Numbered by their first triangle.
    Components result;
    std::vector<int> number(mesh.position.size(), -1);
    result.triangle_component.reserve(mesh.triangle.size());
    for (const Corners& t : mesh.triangle) {
        int& n = number[sets.root(t[0])];
        if (n < 0) n = result.count++;
        result.triangle_component.push_back(n);
    }
    return result;
}

void smooth_by_crease_angle(TriMesh& mesh, double crease_angle) {
    const std::size_t count = mesh.triangle.size();
    std::vector<Vec3> normal(count);
    for (std::size_t t = 0; t < count; ++t)
        normal[t] = area_vector(mesh.position, mesh.triangle[t]).stableNormalized();
    const double least_cosine = portable::cos(crease_angle);
    smooth_across_edges(mesh,
                        [&](int a, int b) { return !(normal[a].dot(normal[b]) < least_cosine); });
}

void smooth_by_face_groups(TriMesh& mesh, const std::vector<int>& triangle_group) {
    smooth_across_edges(mesh, [&](int a, int b) {
        if (triangle_group[a] > 0) return triangle_group[a] == triangle_group[b];
        return !mesh.triangle_polygon.empty() &&
               mesh.triangle_polygon[a] == mesh.triangle_polygon[b];
    });
}

namespace {

// What a face makes of a normal as it moves: F^-T n, where F takes its edges `a` and `b` to `c` and
// `d`, and what is behind it keeps its volume. Zero where the face has no area.
Vec3 follow_face(const Vec3& normal, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 before = a.cross(b), now = c.cross(d);
    const double area2_before = before.squaredNorm(), area2 = now.squaredNorm();
    if (area2_before <= 0 || area2 <= 0) return Vec3::Zero();
    const Vec3 slope = (normal.dot(a) * d.cross(now) + normal.dot(b) * now.cross(c)) / area2;
    return (normal.dot(before) / area2_before * now + slope).stableNormalized();
}

std::vector<Vec3> sum_over_corners(const TriMesh& mesh,
                                   const std::vector<std::array<Vec3, 3>>& share) {
    std::vector<Vec3> sum(mesh.smooth_group_count, Vec3::Zero());
    for (std::size_t t = 0; t < share.size(); ++t)
        for (int k = 0; k < 3; ++k) sum[mesh.triangle_smooth[t][k]] += share[t][k];
    return sum;
}

}  // namespace

std::vector<Vec3> smooth_normals(const TriMesh& mesh, const std::vector<Vec3>& position) {
    const std::size_t count = mesh.triangle.size();
    const bool any_kept = !mesh.smooth_normal.empty();
    std::vector<std::array<Vec3, 3>> share(count);
    std::vector<std::array<Vec3, 3>> kept(any_kept ? count : 0);
    parallel_each(count, kChunk, [&](std::size_t t) {
        const Corners& c = mesh.triangle[t];
        const std::array<Vec3, 3> p = {position[c[0]], position[c[1]], position[c[2]]};
        const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
        const double twice_area = cross.norm();
        for (int k = 0; k < 3; ++k) {
            const Vec3 out = p[(k + 1) % 3] - p[k];
            const Vec3 in = p[(k + 2) % 3] - p[k];
            const double angle = twice_area > 0 ? portable::atan2(twice_area, out.dot(in)) : 0.0;
            share[t][k] = twice_area > 0 ? Vec3(cross * (angle / twice_area)) : Vec3(Vec3::Zero());
            if (!any_kept) continue;
            const auto group = static_cast<std::size_t>(mesh.triangle_smooth[t][k]);
            const bool is_kept = group < mesh.smooth_normal.size();
            const Vec3& from = mesh.position[c[k]];
            kept[t][k] =
                is_kept ? Vec3(angle * follow_face(mesh.smooth_normal[group],
                                                   mesh.position[c[(k + 1) % 3]] - from,
                                                   mesh.position[c[(k + 2) % 3]] - from, out, in))
                        : Vec3(Vec3::Zero());
        }
    });
    std::vector<Vec3> normal = sum_over_corners(mesh, share);
    const std::vector<Vec3> followed = sum_over_corners(mesh, kept);
    for (std::size_t g = 0; g < normal.size(); ++g) {
        Vec3& n = normal[g];
        if (any_kept && followed[g].norm() > 0) n = followed[g];
        const double length = n.norm();
        n = length > 0 ? Vec3(n / length) : Vec3(Vec3::UnitZ());  // only degenerate faces: any
    }
    return normal;
}

void keep_smooth_normals(TriMesh& mesh) {
    if (mesh.triangle_smooth.empty()) return;
    const std::vector<Vec3> now = smooth_normals(mesh, mesh.position);
    mesh.smooth_normal.resize(now.size(), Vec3::Zero());
    for (std::size_t g = 0; g < now.size(); ++g) {
        if (mesh.smooth_normal[g] == Vec3::Zero()) mesh.smooth_normal[g] = now[g];
    }
}

int excess(std::span<const EdgeUse> uses) {
    int sum = 0;
    for (const EdgeUse& use : uses) sum += use.forward ? 1 : -1;
    return sum;
}

bool is_closed(const TriMesh& mesh) {
    bool closed = true;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()),
                  [&](auto uses) { closed = closed && excess(uses) == 0; });
    return closed;
}

}  // namespace swage
