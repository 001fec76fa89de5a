// SPDX-License-Identifier: GPL-3.0-or-later
// Particles are molded with the mass of the layer that they stand in the middle of; a blade goes
// anywhere between them. As it has parted the matter, its pieces get the mass that lies on their
// side of its path, and its centre.
#pragma once

#include <span>

#include "matter/aggregate.h"
#include "sim/sever.h"

namespace swage {

// After sever() with these events. The masses of a piece's particles are multiplied by what grows
// evenly along a line, between half and one and a half of its mean, so that steps stay about as
// long; where that does not reach its centre, the mass alone is right. No piece gets less than a
// quarter of what its particles had as molded. What was one piece keeps its mass, its momentum and
// its moment of momentum. Returns the kinetic energy that is lost [J].
double weigh_pieces(Aggregate& matter, std::span<const SeverEvent> events);

double kinetic_energy(const Aggregate& matter);  // [J]

}  // namespace swage
