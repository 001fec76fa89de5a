// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/caps.h"

#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"

namespace swage {

HoleCaps caps_over_holes(const TriMesh& mesh) {
    struct RimEdge {
        int from, to, times;  // as the missing triangle would run
    };
    std::vector<RimEdge> rim;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        const int balance = excess(uses);
        if (balance > 0) rim.push_back({uses[0].high, uses[0].low, balance});
        if (balance < 0) rim.push_back({uses[0].low, uses[0].high, -balance});
    });
    HoleCaps caps;
    if (rim.empty()) return caps;

    DisjointSets sets(mesh.position.size());
    for (const RimEdge& edge : rim) sets.unite(edge.from, edge.to);
    std::vector<int> hole(mesh.position.size(), -1);
    std::vector<double> length;
    for (const RimEdge& edge : rim) {
        int& h = hole[sets.root(edge.from)];
        if (h < 0) {
            h = static_cast<int>(caps.apex.size());
            caps.apex.push_back(Vec3::Zero());
            length.push_back(0);
        }
        const Vec3 &a = mesh.position[edge.from], &b = mesh.position[edge.to];
        // Never nothing: a rim of points in one place has its middle there too.
        const double weight = std::max((b - a).norm(), 1e-300);
        caps.apex[h] += weight * 0.5 * (a + b);
        length[h] += weight;
        const int apex = static_cast<int>(mesh.position.size()) + h;
        for (int n = 0; n < edge.times; ++n) caps.triangle.push_back({edge.from, edge.to, apex});
    }
    for (std::size_t h = 0; h < length.size(); ++h) caps.apex[h] /= length[h];
    return caps;
}

TriMesh with_caps(const TriMesh& mesh, const HoleCaps& caps) {
    TriMesh closed;
    closed.position = mesh.position;
    closed.triangle = mesh.triangle;
    closed.position.insert(closed.position.end(), caps.apex.begin(), caps.apex.end());
    closed.triangle.insert(closed.triangle.end(), caps.triangle.begin(), caps.triangle.end());
    return closed;
}

}  // namespace swage
