// SPDX-License-Identifier: GPL-3.0-or-later
// Grips that move against each other and hold pieces that nothing joins.
#pragma once

#include <string>

#include "machines/machine.h"
#include "scene/spec.h"

namespace swage {

// What each grip holds, where no piece is held by two that move against each other, so that none is
// deformed by them. `matter`: the work-piece as the machine was set up at it. Empty: one is, the
// grips do not move so, blades part the work-piece here anyway, or it is one piece.
std::string parted_grips(const StageSpec& stage, const Machine& machine, const Aggregate& matter);

}  // namespace swage
