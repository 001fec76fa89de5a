// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/draw_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace swage {

DrawMesh split_corners(const TriMesh& mesh) {
    DrawMesh out;
    const std::size_t triangles = mesh.triangle.size();
    const bool has_uv = !mesh.triangle_uv.empty();
    const bool has_material = !mesh.triangle_material.empty();

    // Material, and whether it is textured.
    std::vector<std::pair<int, bool>> look(triangles, {-1, has_uv});
    for (std::size_t t = 0; t < triangles; ++t) {
        if (has_material) look[t].first = mesh.triangle_material[t];
        if (has_uv) look[t].second = std::ranges::min(mesh.triangle_uv[t]) >= 0;
    }
    std::vector<std::uint32_t> order(triangles);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return look[a] < look[b]; });

    // A chain of the vertices made so far at each position; nearly always one or two long.
    std::vector<std::int32_t> first(mesh.position.size(), -1), next;
    out.index.reserve(3 * triangles);
    for (const std::uint32_t t : order) {
        if (out.range.empty() ||
            std::pair(out.range.back().material, out.range.back().textured) != look[t]) {
            out.range.push_back(
                {look[t].first, look[t].second, static_cast<std::uint32_t>(out.index.size()), 0});
        }
        out.range.back().count += 3;
        for (std::size_t c = 0; c < 3; ++c) {
            const int position = mesh.triangle[t][c];
            const int smooth = mesh.triangle_smooth[t][c];
            const int uv = has_uv ? mesh.triangle_uv[t][c] : -1;
            std::int32_t vertex = first[static_cast<std::size_t>(position)];
            while (vertex >= 0) {
                const auto v = static_cast<std::size_t>(vertex);
                if (out.vertex_smooth[v] == smooth && out.vertex_uv[v] == uv) break;
                vertex = next[v];
            }
            if (vertex < 0) {
                vertex = static_cast<std::int32_t>(out.vertex_position.size());
                out.vertex_position.push_back(position);
                out.vertex_smooth.push_back(smooth);
                out.vertex_uv.push_back(uv);
                next.push_back(first[static_cast<std::size_t>(position)]);
                first[static_cast<std::size_t>(position)] = vertex;
            }
            out.index.push_back(static_cast<std::uint32_t>(vertex));
        }
    }
    out.triangle = std::move(order);
    return out;
}

}  // namespace swage
