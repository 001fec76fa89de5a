// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/topology.h"

#include <algorithm>

#include "geometry/edges.h"

namespace swage {

std::optional<int> euler_inside(const TriMesh& mesh) {
    bool closed = true;
    int edges = 0;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        closed = closed && uses.size() == 2 && uses[0].forward != uses[1].forward;
        ++edges;
    });
    std::vector<char> used(mesh.position.size(), 0);
    for (const Corners& t : mesh.triangle)
        for (int p : t) used[p] = 1;
    const int corners = static_cast<int>(std::count(used.begin(), used.end(), 1));
    const int surface = corners - edges + static_cast<int>(mesh.triangle.size());
    if (!closed || surface % 2 != 0) return std::nullopt;
    return surface / 2;  // a closed surface counts twice what it bounds
}

int euler_of(const Aggregate& matter) {
    int euler =
        static_cast<int>(matter.particle_count()) - static_cast<int>(matter.cell_fill.size());
    const auto present = [&](int direction) {
        const SparseArray<float>& weight = matter.connection[direction].weight;
        int count = 0;
        for (std::size_t p = 0; p < weight.size(); ++p) count += weight[p] > 0;
        return count;
    };
    for (int d = 0; d < kEdgeCount; ++d) euler -= present(d);
    // One of the two diagonals of each face.
    for (int d = kEdgeCount; d < kForwardCount; d += 2) euler += present(d);
    return euler;
}

int count_bodies(const TriMesh& mesh) {
    const Components parts = surface_components(mesh);
    const Vec3 center = box_of(mesh.position).center();
    std::vector<double> volume(parts.count, 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners& c = mesh.triangle[t];
        const Vec3 a = mesh.position[c[0]] - center;
        volume[parts.triangle_component[t]] +=
            a.dot((mesh.position[c[1]] - center).cross(mesh.position[c[2]] - center));
    }
    return static_cast<int>(
        std::count_if(volume.begin(), volume.end(), [](double v) { return v > 0; }));
}

}  // namespace swage
