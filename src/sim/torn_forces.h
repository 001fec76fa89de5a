// SPDX-License-Identifier: GPL-3.0-or-later
// Loads and grips on points of the surface whose cells a blade or a crack has torn.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/point_side.h"

namespace swage {

// What carries each of a force's points; empty: none is torn, and its own cells do.
// NOTE: where a torn point has no whole cell on its side what is left of its own would be driven
// about. Its force acts on the nearest point of the same piece that is not torn or, where there is
// none near, on the corners on its side.
std::vector<PointCarriage> bearers(const Load& load, const Aggregate& matter);

// Of a pressure, whose points `is_off` tells to be parted; what no whole cell carries has no area
// to press on.
std::vector<PointCarriage> pressed_bearers(const Load& load, const Aggregate& matter,
                                           const std::vector<char>& is_parted);

// Of a grip; empty: none of its points is torn. It lets go of what no whole cell carries, and of
// what its edge leaves of less than half of a patch whose neighbours in it are of another piece.
std::vector<PointCarriage> holders(const Grip& grip, const Aggregate& matter);

}  // namespace swage
