// SPDX-License-Identifier: GPL-3.0-or-later
// Slots, notches and folds that are too narrow for the cells: those on both sides of the gap share
// their corners, or are one cell, and hold together what the mesh has apart.
#pragma once

#include <vector>

#include "mold/frame.h"
#include "mold/shares.h"

namespace swage {

struct FilledGap {
    Vec3 place;    // its middle [m]
    double width;  // about, where it is least [m]
    double area;   // that is held together [m2]
};

// Largest first. Of each face that two cells share, and across each cell, the section of the matter
// is exact: there is none, and matter on both sides. Grooves of a single cell's depth are not told.
std::vector<FilledGap> filled_gaps(const std::vector<CellLayer>& layers, const MoldFrame& frame);

}  // namespace swage
