// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a blade goes into matter, be it between particles, where it severs nothing.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// `swept`: by the blades, on a way on which the matter hardly moves. Cells filled in part do not
// count, as the blade may pass beside what they hold.
bool enters_matter(const std::vector<std::array<Vec3, 3>>& swept, const Aggregate& matter);

// Whether a blade that moves comes no nearer than a cell to any particle.
bool passes_beside(const std::vector<std::array<Vec3, 3>>& swept, const Aggregate& matter);

}  // namespace swage
