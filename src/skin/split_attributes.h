// SPDX-License-Identifier: GPL-3.0-or-later
// What a split surface carries over from the old one: texture, smoothing, colours, materials.
#pragma once

#include "geometry/trimesh.h"
#include "skin/surface_split.h"

namespace swage {

// The mesh after the split. Its smooth groups are to have their normals (keep_smooth_normals()).
// `reference`: the place at molding of each added vertex, in the order of SurfaceSplit::added;
// `share`: of each cut point, along its edge at molding. `insides`: whose looks caps get.
TriMesh apply_split(const TriMesh& mesh, const SurfaceSplit& split,
                    const std::vector<Vec3>& reference, const std::vector<double>& share,
                    const Insides& insides = {});

}  // namespace swage
