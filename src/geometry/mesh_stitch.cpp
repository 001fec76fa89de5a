// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_stitch.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/box.h"
#include "geometry/close_points.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/mesh_edit.h"

namespace swage {

namespace {

constexpr double kMostOfEdge = 0.2;  // of the shortest border edge at either of two that are merged

struct Border {
    std::vector<EdgeUse> edge;
    std::vector<int> vertex;
    std::vector<Vec3> place;          // of each vertex
    std::vector<double> edge_length;  // the shortest at each vertex that has a length at all
};

Border border_of(const TriMesh& mesh) {
    Border border;
    std::vector<double> shortest(mesh.position.size(), 0);
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        if (uses.size() % 2 == 0) return;
        const EdgeUse& e = uses[0];
        border.edge.push_back(e);
        const double length = (mesh.position[e.low] - mesh.position[e.high]).norm();
        for (const int i : {e.low, e.high}) {
            if (shortest[i] == 0) shortest[i] = std::numeric_limits<double>::infinity();
            if (length > 0) shortest[i] = std::min(shortest[i], length);
        }
    });
    for (std::size_t i = 0; i < shortest.size(); ++i) {
        if (shortest[i] == 0) continue;
        border.vertex.push_back(static_cast<int>(i));
        border.place.push_back(mesh.position[i]);
        border.edge_length.push_back(shortest[i]);
    }
    return border;
}

// How many were merged; 0: none, or a rim would have shrunk.
std::size_t merge_within(TriMesh& mesh, const Border& border, double gap) {
    DisjointSets same(mesh.position.size());
    std::size_t merged = 0;
    for_each_close_pair(border.place, gap, [&](int a, int b) {
        if ((border.place[a] - border.place[b]).norm() >
            kMostOfEdge * std::min(border.edge_length[a], border.edge_length[b]))
            return;
        const int i = border.vertex[a], j = border.vertex[b];
        if (same.root(i) == same.root(j)) return;
        same.unite(i, j);
        ++merged;
    });
    // From one to the next, and so along the border after all.
    for (const EdgeUse& e : border.edge)
        if (same.root(e.low) == same.root(e.high) && mesh.position[e.low] != mesh.position[e.high])
            return 0;
    std::vector<char> keep;
    for (Corners& t : mesh.triangle) {
        for (int& i : t) i = same.root(i);
        keep.push_back(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    }
    keep_triangles(mesh, keep);
    return merged;
}

std::size_t odd_edges(const TriMesh& mesh) {
    std::size_t odd = 0;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()),
                  [&](auto uses) { odd += uses.size() % 2; });
    return odd;
}

}  // namespace

Stitching stitch_borders(TriMesh& mesh) {
    const double diagonal = box_of(mesh.position).size().norm();
    const Border border = border_of(mesh);
    Stitching best;
    best.odd_before = best.odd_after = border.edge.size();
    TriMesh stitched;
    for (const double share : {1e-8, 1e-7, 1e-6, 1e-5, 1e-4}) {
        TriMesh trial = mesh;
        const std::size_t merged = merge_within(trial, border, share * diagonal);
        const std::size_t odd = merged > 0 ? odd_edges(trial) : best.odd_after;
        if (odd >= best.odd_after) continue;
        best.merged = merged;
        best.gap = share * diagonal;
        best.odd_after = odd;
        stitched = std::move(trial);
        if (odd == 0) break;
    }
    if (best.merged > 0) mesh = std::move(stitched);
    return best;
}

}  // namespace swage
