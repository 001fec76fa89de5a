// SPDX-License-Identifier: GPL-3.0-or-later
// Which boxes are near each other, by splitting them in halves: about linear in boxes and pairs.
#pragma once

#include <utility>
#include <vector>

#include "geometry/box.h"

namespace swage {

// Pairs of numbers, the lower one first, of boxes between which the gap is at most this. Sorted.
// Empty boxes are near none.
std::vector<std::pair<int, int>> near_boxes(const std::vector<Box>& box, double gap);

}  // namespace swage
