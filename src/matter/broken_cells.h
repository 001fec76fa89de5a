// SPDX-License-Identifier: GPL-3.0-or-later
// What load has broken of a body.
#pragma once

#include "matter/aggregate.h"

namespace swage {

bool any_damaged(const Aggregate& matter);
// Whether it has reached its strength, or a blade has crossed it and load has damaged what is left.
// `row`: its low row ends.
bool cell_has_broken(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row);
// Whether it presses along this axis where it is pushed shut, as the fracture law has it: load has
// broken some of its connections, and no blade has severed an edge of it along the axis.
bool closes_as_crack(const Aggregate& matter, const std::array<ParticleId, 4>& row, int axis);

}  // namespace swage
