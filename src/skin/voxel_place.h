// SPDX-License-Identifier: GPL-3.0-or-later
// Where the points of a voxel surface belong at molding.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "skin/voxel_surface.h"
#include "skin/warp.h"

namespace swage {

// Of each site [m].
struct PointPlaces {
    // On the body's true surface where that is known; on smooth cut faces half-way between the
    // particles that were severed; where they broke by load, off that by the warp. The enclosed
    // volume is the matter's.
    std::vector<Vec3> place;
    // Where the voxels have them.
    std::vector<Vec3> lattice;
    // The same, but where anything broke for those outside of the true surface, which are drawn in
    // to a tenth of their height above it: points that cannot be where they belong rest there.
    std::vector<Vec3> rest;
};

// Crumbs (skin/voxel_crumbs.h) are dropped.
PointPlaces place_points(const Aggregate& matter, const Pieces& pieces,
                         const SurfaceSamples& samples, const Warp& warp, VoxelSurface& surface);

}  // namespace swage
