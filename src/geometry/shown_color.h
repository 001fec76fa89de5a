// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of surfaces as they are drawn: of a material times those of the vertices, where it takes
// them. Images are not in them.
#pragma once

#include <optional>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/trimesh.h"

namespace swage {

// A mesh without materials is drawn by the default one.
const SurfaceMaterial& material_of(const TriMesh& mesh, std::size_t triangle);

Eigen::Vector3f shown_color(const TriMesh& mesh, std::size_t triangle, int position);

// One a position; none where faces that meet there differ.
std::optional<std::vector<Eigen::Vector3f>> colors_of_positions(const TriMesh& mesh);

struct CornerColors {
    std::vector<Eigen::Vector3f> value;  // each once
    std::vector<int> index;              // of each corner of the polygons
};
CornerColors corner_colors(const TriMesh& mesh, const PolygonCorners& polygons);

}  // namespace swage
