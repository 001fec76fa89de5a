// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/shown_color.h"

#include <map>

namespace swage {

const SurfaceMaterial& material_of(const TriMesh& mesh, std::size_t triangle) {
    static const SurfaceMaterial plain;
    if (mesh.material.empty()) return plain;
    return mesh.material.at(
        mesh.triangle_material.empty() ? 0 : std::size_t(mesh.triangle_material[triangle]));
}

Eigen::Vector3f shown_color(const TriMesh& mesh, std::size_t triangle, int position) {
    const SurfaceMaterial& material = material_of(mesh, triangle);
    if (!material.takes_colors || mesh.position_color.empty()) return material.color.cast<float>();
    return material.color.cwiseProduct(mesh.position_color[position].cast<double>()).cast<float>();
}

std::optional<std::vector<Eigen::Vector3f>> colors_of_positions(const TriMesh& mesh) {
    std::vector<Eigen::Vector3f> color(mesh.position.size(), Eigen::Vector3f::Zero());
    std::vector<char> is_known(color.size(), 0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (const int v : mesh.triangle[t]) {
            const Eigen::Vector3f here = shown_color(mesh, t, v);
            if (is_known[v] && color[v] != here) return std::nullopt;
            is_known[v] = 1;
            color[v] = here;
        }
    }
    return color;
}

CornerColors corner_colors(const TriMesh& mesh, const PolygonCorners& polygons) {
    CornerColors colors;
    std::map<std::array<float, 3>, int> number;
    for (const int corner : polygons.corner) {
        const std::size_t t = std::size_t(corner / 3);
        const Eigen::Vector3f color = shown_color(mesh, t, mesh.triangle[t][corner % 3]);
        const auto [at, is_new] = number.try_emplace({color[0], color[1], color[2]},
                                                     static_cast<int>(colors.value.size()));
        if (is_new) colors.value.push_back(color);
        colors.index.push_back(at->second);
    }
    return colors;
}

}  // namespace swage
