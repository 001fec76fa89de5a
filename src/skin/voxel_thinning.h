// SPDX-License-Identifier: GPL-3.0-or-later
// Which voxels a surface should be drawn around. A voxel is an eighth of a cell, at one of its
// corners.
#pragma once

#include <vector>

#include "skin/carrier.h"
#include "skin/surface_samples.h"

namespace swage {

// A bit for each voxel of each cell: all but those that lie well outside the true surface, and at
// cuts those that hold nothing, as long as taking them away changes neither pieces nor holes nor
// handles. Where a cut ends all stay, and elsewhere those that no full cell is beside.
std::vector<CornerMask> voxels_to_draw(const Aggregate& matter, const SurfaceSamples& samples);

}  // namespace swage
