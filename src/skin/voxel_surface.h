// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of the matter's voxels. A voxel is an eighth of a cell, half a spacing wide, and meets
// one particle: the corner that it lies at.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/polygon.h"
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
    // A vertex within the edge from each corner to the next; -1: none. NOTE: two sheets may meet at
    // both ends of an edge and not between them. One of them has a vertex more there, for else the
    // edge would have four faces.
    std::array<int, 4> middle = {-1, -1, -1, -1};
    // That it has to be parted by, for the two sides of a cut share both ends of the other one.
    std::optional<Diagonal> diagonal = std::nullopt;
};

struct VoxelSurface {
    std::vector<HalfSite> site;
    std::vector<VoxelFace> face;
    int vertex_count = 0;
    std::vector<CornerMask> kept;  // voxels of each cell that it is drawn around
};

// The triangles of a face, by its shorter diagonal where it need not be one.
std::array<Corners, 2> halves_of(const std::array<int, 4>& corner, const std::vector<Vec3>& place,
                                 std::optional<Diagonal> diagonal);

VoxelSurface voxel_surface(const Aggregate& matter, const SurfaceSamples& samples);

}  // namespace swage
