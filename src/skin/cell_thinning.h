// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Cells that a surface should be drawn around: all but those less than half full that lie against
// the body, as long as taking them away changes neither pieces nor holes nor handles.
std::vector<char> cells_to_draw(const Aggregate& matter);

}  // namespace swage
