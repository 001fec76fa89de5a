// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/divided_mesh.h"

#include <algorithm>
#include <limits>

#include "geometry/edges.h"
#include "skin/split_attributes.h"

namespace swage {

namespace {

// A halved triangle's new edges are at most 0.87 of its longest: where the longest does not become
// so much shorter, numbers have no places left for its middle.
constexpr double kShorter = 0.9;

using Middles = std::vector<Corners>;  // a triangle each: the new vertex on each side, or -1

// Into four, three or two.
void split_triangle(const TriMesh& mesh, int t, const Corners& middle,
                    const std::vector<Vec3>& position, SurfaceSplit& split) {
    const auto add = [&](const Corners& c) { split.triangle.push_back({c, c, t, true, 0}); };
    const Corners& own = mesh.triangle[t];
    const auto count = 3 - std::count(middle.begin(), middle.end(), -1);
    if (count == 0) {
        split.triangle.push_back({own, own, t, false, 0});
        return;
    }
    int k = 0;  // the side that is split alone, or alone not
    while ((middle[k] >= 0) != (count != 2)) ++k;
    const int a = own[k], b = own[(k + 1) % 3], c = own[(k + 2) % 3];
    const int ab = middle[k], bc = middle[(k + 1) % 3], ca = middle[(k + 2) % 3];
    if (count == 1) {
        add({a, ab, c}), add({ab, b, c});
    } else if (count == 2) {
        add({c, ca, bc});
        const double from_a = (position[bc] - position[a]).squaredNorm();
        const double from_b = (position[ca] - position[b]).squaredNorm();
        if (from_a <= from_b) {
            add({a, b, bc}), add({a, bc, ca});
        } else {
            add({a, b, ca}), add({b, bc, ca});
        }
    } else {
        add({a, ab, ca}), add({ab, b, bc}), add({ca, bc, c}), add({ab, bc, ca});
    }
}

double longest_edge(const TriMesh& mesh) {
    double longest = 0;
    for (const auto& [a, b, c] : mesh.triangle) {
        const Vec3 &p = mesh.position[a], &q = mesh.position[b], &r = mesh.position[c];
        longest = std::max({longest, (q - p).norm(), (r - q).norm(), (p - r).norm()});
    }
    return longest;
}

}  // namespace

TriMesh halve_edges(const TriMesh& mesh, const std::function<bool(int, int)>& is_long,
                    std::vector<EdgeCut>& halved) {
    const int old = static_cast<int>(mesh.position.size());
    SurfaceSplit split;
    std::vector<Vec3> reference, position = mesh.position;
    Middles middle(mesh.triangle.size(), Corners{-1, -1, -1});
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()),
                  [&](std::span<const EdgeUse> edge) {
                      const auto [low, high] = std::pair(edge[0].low, edge[0].high);
                      const Vec3 &from = mesh.position[low], &to = mesh.position[high];
                      if (!is_long(low, high)) return;
                      const int at = old + static_cast<int>(split.cut.size());
                      split.cut.push_back({low, high, 0.5});
                      split.added.push_back({at, 0});
                      reference.push_back(0.5 * (from + to));
                      for (const EdgeUse& use : edge) middle[use.triangle][use.side] = at;
                  });
    position.insert(position.end(), reference.begin(), reference.end());
    for (std::size_t t = 0; t < middle.size(); ++t) {
        split_triangle(mesh, static_cast<int>(t), middle[t], position, split);
    }
    halved = split.cut;
    return apply_split(mesh, split, reference, std::vector<double>(reference.size(), 0.5));
}

TriMesh divide_edges(const TriMesh& mesh, double longest) {
    TriMesh divided = mesh;
    if (longest_edge(mesh) > longest) keep_smooth_normals(divided);
    double before = std::numeric_limits<double>::infinity();
    for (double most = longest_edge(divided); most > longest && most < kShorter * before;
         most = longest_edge(divided)) {
        const double above = std::max(longest, kNearLongest * most);
        const auto is_long = [&](int low, int high) {
            return (divided.position[high] - divided.position[low]).norm() > above;
        };
        std::vector<EdgeCut> halved;
        divided = halve_edges(divided, is_long, halved);
        before = most;
    }
    return divided;
}

}  // namespace swage
