// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes as bytes (base/bytes.h).
#pragma once

#include "base/bytes.h"
#include "geometry/trimesh.h"

namespace swage {

template <typename Io>
void visit(Io& io, SurfaceMaterial& material) {
    auto& [name, color, roughness, metallic, clear, inside, takes_colors, texture,
           embedded_texture] = material;
    io(name, color, roughness, metallic, clear, inside, texture, takes_colors);
    io.image(embedded_texture);
}

template <typename Io>
void visit(Io& io, TriMesh& mesh) {
    auto& [position, triangle, position_color, uv, triangle_uv, smooth_group_count, triangle_smooth,
           smooth_normal, triangle_polygon, triangle_material, triangle_part, material, part_name] =
        mesh;
    io(position, triangle, position_color, uv, triangle_uv, smooth_group_count, triangle_smooth,
       smooth_normal, triangle_polygon, triangle_material, triangle_part, material, part_name);
}

}  // namespace swage
