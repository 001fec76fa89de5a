// SPDX-License-Identifier: GPL-3.0-or-later
// A closed surface around the inside of a sampled scalar field.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/trimesh.h"

namespace swage {

// Samples at origin + spacing * (i, j, k), x fastest.
struct ScalarGrid {
    Vec3 origin = Vec3::Zero();
    double spacing = 1;  // [m], > 0
    Vec3i count = Vec3i::Zero();
    std::vector<double> value;  // count.prod() of them, finite

    std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * count.y() + j) * count.x() + i;
    }
    Vec3 point(int i, int j, int k) const { return origin + spacing * Vec3(i, j, k); }
};

// The surface where `value` crosses `iso`: inside is below it, everything beyond the grid is
// outside. Every edge has exactly two triangles and every position one fan of them, whatever the
// values: where the inside touches itself across a face or an edge of the grid, the positions are
// separate (they may coincide). Positions, triangles and triangle_polygon are filled; each quad
// lies around one edge of the grid. Throws Error(mesh) when the grid's sizes do not agree.
TriMesh surface_nets(const ScalarGrid& grid, double iso = 0);

}  // namespace swage
