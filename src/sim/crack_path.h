// SPDX-License-Identifier: GPL-3.0-or-later
// Which of the cells beyond their strength go on as a crack, and which are spared because of the
// cracks near them.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/fracture_laws.h"

namespace swage {

struct StrainedCell {
    CellId cell;
    Vec3i site;
    Vec3 pull;  // unit vector at molding along which it is strained most
};
StrainedCell strained_cell(const Aggregate& matter, const CellRun& run, int n);

// Whether a cell in line with this one, along its pull, has cracked.
//
// A cell that has cracked relieves what it is in line with, in motion only as fast as it opens: all
// around the tip would crack until then, a cloud too blunt to go on.
bool is_beside_crack(const Aggregate& matter, const StrainedCell& cell);

// Whether two such cells are in line with each other.
bool are_in_line(const StrainedCell& one, const StrainedCell& other);

// From 1 to 2: by how much a cell must be strained more for lying off the track of the crack near
// it. The track is the plane through the middle of what is broken around the cell, across the mean
// pull of what is whole next to it. Each counts by the fourth power of its strain: what is strained
// otherwise, the arms of a double cantilever as they bend, has no say. It is 1 where what lies on
// the track does not break or is that much stronger: a weak layer slides along itself.
//
// NOTE: ahead of a tip the next cell along an axis of the lattice is strained most, whatever the
// load: without the track a crack at 22.5 degrees turned onto the axis (8 spacings off over 11).
// Crack tracking: Cervera, Chiumenti, Int. J. Numer. Anal. Meth. Geomech. 30 (2006), 1173.
double off_track_factor(const Aggregate& matter, const FractureLaws& laws,
                        const StrainedCell& cell);

}  // namespace swage
