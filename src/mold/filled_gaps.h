// SPDX-License-Identifier: GPL-3.0-or-later
// Slots, notches and folds that are too narrow for the cells: those on both sides of the gap share
// their corners, or are one cell, and hold together what the mesh has apart.
#pragma once

#include <vector>

#include "mold/frame.h"
#include "mold/shares.h"

namespace swage {

struct FilledGap {
    Vec3 place;      // its middle, in the mesh [m]
    double width;    // about, of most of it [m]; 0: its sides touch
    double area;     // that is held together [m2]
    double spacing;  // that keeps it open [m]; 0: none does, it narrows to nothing
};

// Largest first. Sides that hang together in the cells around are no gap: grooves of a single
// cell's depth are not told. Nor is it where parts of the surface cross.
std::vector<FilledGap> filled_gaps(const TriMesh& mesh, const std::vector<CellLayer>& layers,
                                   const MoldFrame& frame);

}  // namespace swage
