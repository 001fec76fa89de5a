// SPDX-License-Identifier: GPL-3.0-or-later
// Where the mass lies: not only as much as the mesh has, but as far out.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Particles of a lattice hold their cells' mass at the corners, further out than the material is: a
// square bar of n cells would turn about its axis as if it had 1 + 2/n^2 times its moment of
// inertia. Moves mass between the particles, as little as will do, until the mass, its centre and
// its second moments (so all moments of inertia) are the material's. Each particle keeps between
// kLeastMass and kMostMass (moments.cpp) of what it had, so that steps stay long: second moments
// that would need more, mostly of bodies of one or two cells, come as near as that lets them. Where
// the centre needs more, these bounds are widened until it is met. Call once after molding, with
// all particles where they were molded. Returns by how much the centre is missed [cells].
double match_moments(Aggregate& matter);

}  // namespace swage
