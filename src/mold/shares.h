// SPDX-License-Identifier: GPL-3.0-or-later
// The exact share of every cell inside a mesh, and the mesh's surface in pieces, cell by cell.
#pragma once

#include <array>
#include <vector>

#include "geometry/trimesh.h"
#include "mold/frame.h"

namespace swage {

// A cell that holds material.
struct CellFill {
    int i, j;
    double fill;  // share of its volume; may pass 0 or 1 a little where the surface crosses itself
    Vec3 moment;  // fill times the centroid, in cells from the cell's centre
};

// Surface of one bin whose normals point most along one of the six axis directions.
struct SurfacePatch {
    int i, j;     // the cell it lies in
    Vec3 center;  // [bins]
    Vec3 normal;  // unit, outward
    double area;  // [m2]
};

// One layer of cells along z.
struct CellLayer {
    std::vector<CellFill> share;      // sorted by j, i
    std::vector<SurfacePatch> patch;  // sorted by j, i
    double surplus = 0;               // [cells], filled more than once by overlapping parts
    double deficit = 0;  // [cells], filled less than not at all by parts turned inside out
};

// The surface must be closed (mold/caps.h). What of it reaches out of the frame's box is cut off.
std::vector<CellLayer> share_cells(const TriMesh& mesh, const MoldFrame& frame);

inline constexpr double kLeastFill = 1e-3;

// Null: the cell holds nothing.
const CellFill* share_of(const std::vector<CellLayer>& layers, int i, int j, int k);

// A cell's material that a neighbour has been given.
struct SliverMove {
    Vec3i from, to;
};

// Gives the material of cells with less than kLeastFill to their fullest face neighbours and takes
// those cells out. Returns what had no neighbour and is lost [cells].
double drop_slivers(std::vector<CellLayer>& layers, std::vector<SliverMove>* moves = nullptr);
// The same of what is a part of that body.
void move_slivers(const std::vector<SliverMove>& moves, std::vector<CellLayer>& layers);

}  // namespace swage
