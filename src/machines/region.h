// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the work-piece's surface, as loads choose them.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "machines/machine_spec.h"
#include "matter/aggregate.h"

namespace swage {

struct Region {
    std::vector<int> point;
    std::vector<double> share;  // of each one's patch of the surface, more than 0
};

// What of the surface looks to the side now and lies in the box (null: anywhere), both in the work
// frame. `in_work`: where the surface's points are in it.
// NOTE: a patch counts as the box around it, which is exact for flat sides along the lattice; that
// of a slanted one goes over into the next evenly.
Region find_region(const Aggregate& matter, const Pose& world_from_work,
                   const std::vector<Vec3>& in_work, Side side, const Box* box);

// Whether the points make up whole closed surfaces: none of them has a neighbour that is left out.
bool is_closed(const Aggregate& matter, const std::vector<int>& points);

}  // namespace swage
