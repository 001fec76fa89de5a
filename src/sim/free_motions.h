// SPDX-License-Identifier: GPL-3.0-or-later
// Motions of a body as a whole that what holds it does not hinder, as of a plate between smooth
// jaws: along these it is in neutral equilibrium, whatever it bears.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/held_point.h"

namespace swage {

// Shifts and turns of the body as it is, up to six; orthogonal by mass, each of unit mass.
std::vector<Vec3Array> free_motions(const Aggregate& matter, const std::vector<HeldPoint>& held);

}  // namespace swage
