// SPDX-License-Identifier: GPL-3.0-or-later
// What may go wrong by where a machine's parts start and how they go, in sentences for its user.
#pragma once

#include <string>
#include <vector>

#include "machines/machine.h"

namespace swage {

// Whether the n-th blade is where it starts at all times, whatever its motion is written like.
bool blade_stands(const Machine& machine, std::size_t n);

// `touch`: what of the work-piece meets tools, in the work frame [m]. `spacing`: that is asked for;
// the matter may be of a larger one [m].
std::vector<std::string> start_notes(const Machine& machine, const Aggregate& matter,
                                     const std::vector<Vec3>& touch, double spacing);

}  // namespace swage
