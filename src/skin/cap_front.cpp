// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cap_front.h"

#include <map>
#include <set>

namespace swage {

namespace {

Ends edge_of(const Corners& t, int k) { return ends(t[k], t[(k + 1) % 3]); }

struct Edges {
    std::map<Ends, int> triangles;
    std::set<int> shared;  // by both sides: the ends of edges at which the blade stops
};

Edges edges_of(const CutCaps& caps, const std::function<bool(const Ends&)>& is_seam) {
    Edges edges;
    for (const Corners& t : caps.triangle) {
        for (int k = 0; k < 3; ++k) ++edges.triangles[edge_of(t, k)];
    }
    for (const auto& [edge, count] : edges.triangles) {
        if (count == 1 && !is_seam(edge)) edges.shared.insert({edge.first, edge.second});
    }
    return edges;
}

// An edge that is cut in two, and the triangles at it.
struct Halved {
    int point;
    std::set<std::size_t> triangle;
};

void halve(CutCaps& caps, std::map<Ends, Halved>& halved) {
    for (std::size_t c = 0; c < caps.triangle.size(); ++c) {
        for (int k = 0; k < 3; ++k) {
            const auto at = halved.find(edge_of(caps.triangle[c], k));
            if (at != halved.end()) at->second.triangle.insert(c);
        }
    }
    for (const auto& [edge, cut] : halved) {
        for (const std::size_t c : cut.triangle) {
            Corners& t = caps.triangle[c];
            int k = 0;
            while (edge_of(t, k) != edge) ++k;
            const Ends behind = edge_of(t, (k + 1) % 3);
            Corners other = t;
            t[(k + 1) % 3] = cut.point;
            other[k] = cut.point;
            if (const auto at = halved.find(behind); at != halved.end()) {
                at->second.triangle.erase(c);
                at->second.triangle.insert(caps.triangle.size());
            }
            caps.triangle.push_back(other);
            caps.neighbor.push_back(caps.neighbor[c]);
            caps.inside.push_back(caps.inside[c]);
        }
    }
}

}  // namespace

void part_caps(CutCaps& caps, const std::function<bool(const Ends&)>& is_seam,
               const std::function<void(const Ends&)>& leave,
               const std::function<int(const Ends&)>& half_way) {
    Edges edges = edges_of(caps, is_seam);
    const auto cannot_part = [&](const Ends& edge) {
        return edges.shared.count(edge.first) && edges.shared.count(edge.second);
    };
    for (bool has_left = true; has_left;) {
        CutCaps kept;
        for (std::size_t c = 0; c < caps.triangle.size(); ++c) {
            const Corners& t = caps.triangle[c];
            bool parts = false, tears = false;
            for (int k = 0; k < 3; ++k) {
                const Ends edge = edge_of(t, k);
                const bool at_rim = edges.triangles.at(edge) == 1;
                parts = parts || !at_rim || !cannot_part(edge);
                tears = tears || (at_rim && is_seam(edge) && cannot_part(edge));
            }
            if (parts && !tears) {
                kept.triangle.push_back(t);
                kept.neighbor.push_back(caps.neighbor[c]);
                kept.inside.push_back(caps.inside[c]);
                continue;
            }
            for (int k = 0; k < 3; ++k) {
                if (is_seam(edge_of(t, k))) leave(edge_of(t, k));
            }
        }
        has_left = kept.triangle.size() < caps.triangle.size();
        caps = std::move(kept);
        edges = edges_of(caps, is_seam);
    }

    std::map<Ends, Halved> halved;
    for (const auto& [edge, count] : edges.triangles) {
        if (count == 2 && cannot_part(edge)) halved[edge].point = half_way(edge);
    }
    halve(caps, halved);
}

}  // namespace swage
