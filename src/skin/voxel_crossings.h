// SPDX-License-Identifier: GPL-3.0-or-later
// Where a voxel surface runs through itself.
#pragma once

#include <vector>

#include "skin/voxel_surface.h"

namespace swage {

// Four corners, counter-clockwise, and a point within the edge from each to the next; -1: none.
struct Facet {
    std::array<int, 4> corner;
    std::array<int, 4> middle = {-1, -1, -1, -1};
    std::optional<Diagonal> diagonal = std::nullopt;  // as VoxelFace has it
};

// Puts points of facets that cross others back towards `start`, until none do or they are there;
// returns whether any did. `fixed` points stay. `spacing`: of the lattice [m].
bool part_crossings(const std::vector<Facet>& facet, const std::vector<Vec3>& start,
                    const std::vector<char>& fixed, double spacing, std::vector<Vec3>& place);

}  // namespace swage
