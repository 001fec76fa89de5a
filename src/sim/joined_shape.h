// SPDX-License-Identifier: GPL-3.0-or-later
// How matter is deformed where no cell is whole any more, by what is still joined.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// The gradient of place by place at molding that fits best the connections that are left around
// this one and hang together with it. Where these lie in one layer, or in a row, the matter counts
// as neither thinner nor thicker across that, and a row as not turned about itself.
Mat3 joined_deformation(const Aggregate& matter, ParticleId lower, ParticleId upper);

}  // namespace swage
