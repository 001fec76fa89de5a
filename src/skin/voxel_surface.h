// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of the matter's voxels. A voxel is an eighth of a cell, half a spacing wide, and meets
// one particle: the corner that it lies at.
#pragma once

#include <array>
#include <vector>

#include "skin/carrier.h"
#include "skin/surface_samples.h"

namespace swage {

// A place of the half lattice: even numbers are sites of particles.
using HalfSite = std::array<int, 3>;

struct VoxelFace {
    CellId cell;
    int corner;                 // of the cell: with it, the voxel behind the face
    int direction;              // outward: axis + 3 for the negative one
    bool cut;                   // matter was severed here; else there never was any beyond
    std::array<int, 4> point;   // counter-clockwise from outside, into VoxelSurface::site
    std::array<int, 4> vertex;  // the same places, told apart where surfaces only touch
};

struct VoxelSurface {
    std::vector<HalfSite> site;
    std::vector<VoxelFace> face;
    int vertex_count = 0;
    std::vector<CornerMask> kept;  // voxels of each cell that it is drawn around
};

VoxelSurface voxel_surface(const Aggregate& matter, const SurfaceSamples& samples);

}  // namespace swage
