// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a mold kept the topology of its mesh: what is closer than a cell melts together.
#pragma once

#include <optional>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"

namespace swage {

// Euler characteristic of the solid inside: bodies + cavities - handles. None for a surface with
// edges that are not shared by two triangles.
std::optional<int> euler_inside(const TriMesh& mesh);
int euler_of(const Aggregate& matter);

// Separate parts of the surface that enclose matter; cavities do not.
int count_bodies(const TriMesh& mesh);

}  // namespace swage
