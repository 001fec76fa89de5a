// SPDX-License-Identifier: GPL-3.0-or-later
// A section of a body that has gone into itself, taken apart into what can be filled.
#pragma once

#include <optional>
#include <vector>

#include "skin/section.h"

namespace swage {

// The segments by sheet, where sheets lie over each other and their loops may cross: those of a
// loop and of the holes in it, which at rest were nearest to it. What does not close, or is a hole
// in nothing, comes last.
std::vector<std::vector<int>> sheets_of(const Section& section);

// A sheet whose outline crosses itself, as that of matter that has folded into itself, with the
// points of its lobes drawn straight until none crosses: what fills it joins the
// same points. Nothing where that would take more than small lobes.
std::optional<Section> untangled(Section sheet);

}  // namespace swage
