// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the work-piece's surface, as loads choose them.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "machines/machine_spec.h"
#include "matter/aggregate.h"

namespace swage {

// Points of the surface that look to the side now and lie in the box (null: anywhere), both in the
// work frame. `in_work`: where the surface's points are in it.
std::vector<int> region_points(const Aggregate& matter, const Pose& world_from_work,
                               const std::vector<Vec3>& in_work, Side side, const Box* box);

// Whether the points make up whole closed surfaces: none of them has a neighbour that is left out.
bool is_closed(const Aggregate& matter, const std::vector<int>& points);

}  // namespace swage
