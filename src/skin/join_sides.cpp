// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/join_sides.h"

#include <algorithm>
#include <tuple>

#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

struct Use {
    Ends edge;
    int kind;  // 0 surface, 1 cap above, -1 cap below
    int side;
    Ends corner;  // at the edge's ends
    bool operator<(const Use& other) const {
        return std::tie(edge, kind, corner) < std::tie(other.edge, other.kind, other.corner);
    }
};

std::vector<Use> uses_of(const std::vector<SplitTriangle>& triangles, const std::set<int>& parts) {
    std::vector<Use> uses;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const SplitTriangle& triangle = triangles[t];
        for (int k = 0; k < 3; ++k) {
            const int a = triangle.raw[k], b = triangle.raw[(k + 1) % 3];
            if (!parts.count(a) && !parts.count(b)) continue;
            const int ca = static_cast<int>(3 * t + k);
            const int cb = static_cast<int>(3 * t + (k + 1) % 3);
            uses.push_back({ends(a, b), triangle.parent < 0 ? triangle.side : 0, triangle.side,
                            a < b ? Ends(ca, cb) : Ends(cb, ca)});
        }
    }
    std::sort(uses.begin(), uses.end());
    return uses;
}

void number_vertices(const std::set<int>& parts, int old_count, DisjointSets& corners,
                     SurfaceSplit& split) {
    std::map<int, std::pair<int, int>> vertex_side;  // of a set: vertex, side (2: not known)
    std::vector<int> added_set, seam_set;
    std::set<int> taken;
    int next = old_count;
    for (std::size_t t = 0; t < split.triangle.size(); ++t) {
        SplitTriangle& triangle = split.triangle[t];
        for (int k = 0; k < 3; ++k) {
            const int raw = triangle.raw[k];
            if (!parts.count(raw)) continue;
            const int root = corners.root(static_cast<int>(3 * t + k));
            auto [at, fresh] = vertex_side.emplace(root, std::pair(-1, triangle.side));
            auto& [vertex, side] = at->second;
            if (fresh) {
                vertex = raw < old_count && taken.insert(raw).second ? raw : next++;
                (vertex < old_count ? split.at_seam : split.added).push_back({raw, 0});
                if (vertex >= old_count)
                    added_set.push_back(root);
                else
                    seam_set.push_back(root);
            }
            if (side != triangle.side) side = 0;
            triangle.vertex[k] = vertex;
        }
    }
    for (std::size_t n = 0; n < split.added.size(); ++n) {
        split.added[n].side = vertex_side.at(added_set[n]).second;
    }
    for (std::size_t n = 0; n < split.at_seam.size(); ++n) {
        split.at_seam[n].side = vertex_side.at(seam_set[n]).second;
    }
}

}  // namespace

void join_sides(const std::set<int>& parts, const std::set<Ends>& seams, int old_count,
                SurfaceSplit& split) {
    const std::vector<Use> uses = uses_of(split.triangle, parts);
    DisjointSets corners(3 * split.triangle.size());
    const auto join = [&](const Use& x, const Use& y) {
        corners.unite(x.corner.first, y.corner.first);
        corners.unite(x.corner.second, y.corner.second);
    };
    for (std::size_t begin = 0, end; begin < uses.size(); begin = end) {
        for (end = begin; end < uses.size() && uses[end].edge == uses[begin].edge; ++end) {
        }
        const bool seam = seams.count(uses[begin].edge) > 0;
        const auto count = [&](int kind) {
            return std::count_if(uses.begin() + begin, uses.begin() + end,
                                 [&](const Use& u) { return u.kind == kind; });
        };
        // Where the blade stops the two caps meet.
        const bool front = !seam && count(1) == 1;
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t j = i + 1; j < end; ++j) {
                const Use &x = uses[i], &y = uses[j];
                if (seam ? x.side == y.side
                         : x.kind == y.kind || (front && x.kind != 0 && y.kind != 0)) {
                    join(x, y);
                }
            }
        }
    }
    number_vertices(parts, old_count, corners, split);
}

}  // namespace swage
