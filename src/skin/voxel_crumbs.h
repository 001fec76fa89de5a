// SPDX-License-Identifier: GPL-3.0-or-later
// Shells of a voxel surface that are too small to be shown.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "skin/voxel_surface.h"

namespace swage {

// A blade may cut off particles whose cells hold next to no material on that side. Such crumbs are
// not drawn: takes the faces out of all pieces that enclose less than a share of a cell. And of
// whole matter cells that it touches at an edge or a corner only, and gaps that it leaves, may be
// drawn to next to nothing: out go shells that enclose less than a voxel, which is the least that
// the voxels can tell. The largest of each piece stays, for that is all that shows the piece; so do
// the sides of a cut, which enclose nothing until it opens.
void drop_crumbs(const Aggregate& matter, const Pieces& pieces, const std::vector<Vec3>& place,
                 VoxelSurface& surface);

}  // namespace swage
