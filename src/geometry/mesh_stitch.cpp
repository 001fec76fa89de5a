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
constexpr double kWidest = 2;        // gaps, of what becomes one vertex

struct Border {
    std::vector<int> vertex;
    std::vector<Vec3> place;    // of each vertex
    std::vector<double> reach;  // of each: the shortest border edge there that counts
};

// An edge no longer than the gap counts only among its like, as on a fine rim: by itself it may go,
// and so may a lone triangle of such.
Border border_of(const TriMesh& mesh, double gap) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const auto uses_of_edges = edge_uses(mesh.triangle, mesh.position.size());
    std::vector<signed char> sides(mesh.triangle.size(), 0);
    for_each_edge(uses_of_edges, [&](auto uses) {
        if (uses.size() == 1) ++sides[uses[0].triangle];
    });
    std::vector<char> at_border(mesh.position.size(), 0);
    std::vector<double> longer(mesh.position.size(), kNone), shorter(mesh.position.size(), kNone);
    for_each_edge(uses_of_edges, [&](auto uses) {
        if (uses.size() % 2 == 0) return;
        const EdgeUse& e = uses[0];
        const double length = (mesh.position[e.low] - mesh.position[e.high]).norm();
        const bool lone = uses.size() == 1 && sides[e.triangle] == 3;
        for (const int i : {e.low, e.high}) {
            at_border[i] = 1;
            if (length > gap)
                longer[i] = std::min(longer[i], length);
            else if (!lone && length > 0)
                shorter[i] = std::min(shorter[i], length);
        }
    });
    Border border;
    for (std::size_t i = 0; i < at_border.size(); ++i) {
        if (!at_border[i]) continue;
        border.vertex.push_back(static_cast<int>(i));
        border.place.push_back(mesh.position[i]);
        border.reach.push_back(longer[i] < kNone ? longer[i] : shorter[i]);
    }
    return border;
}

// How many were merged; 0: none, or detail would have been lost.
std::size_t merge_within(TriMesh& mesh, double gap) {
    const Border border = border_of(mesh, gap);
    DisjointSets same(mesh.position.size());
    std::size_t merged = 0;
    for_each_close_pair(border.place, gap, [&](int a, int b) {
        const double distance = (border.place[a] - border.place[b]).norm();
        if (distance > kMostOfEdge * std::min(border.reach[a], border.reach[b])) return;
        const int i = border.vertex[a], j = border.vertex[b];
        if (same.root(i) == same.root(j)) return;
        same.unite(i, j);
        ++merged;
    });
    if (merged == 0) return 0;
    // From one to the next they may have run along a row of many.
    std::vector<Box> extent(mesh.position.size());
    for (const int i : border.vertex) extent[same.root(i)].grow(mesh.position[i]);
    for (const int i : border.vertex)
        if (same.root(i) == i && extent[i].size().norm() > kWidest * gap) return 0;
    std::vector<char> keep;
    for (Corners& t : mesh.triangle) {
        for (int& i : t) i = same.root(i);
        keep.push_back(!has_repeated_corner(t));
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
    Stitching done;
    done.odd_before = done.odd_after = odd_edges(mesh);
    // What is nearest first: of a fine part that is whole by then only rims are left to look at.
    for (const double share : {1e-8, 1e-7, 1e-6, 1e-5, 1e-4}) {
        if (done.odd_after == 0) break;
        TriMesh trial = mesh;
        const std::size_t merged = merge_within(trial, share * diagonal);
        const std::size_t odd = merged > 0 ? odd_edges(trial) : done.odd_after;
        if (odd >= done.odd_after) continue;
        done.merged += merged;
        done.gap = share * diagonal;
        done.odd_after = odd;
        mesh = std::move(trial);
    }
    return done;
}

}  // namespace swage
