// SPDX-License-Identifier: GPL-3.0-or-later
// What the pieces of a body hold by the planes that blades went along, wherever these lie between
// the particles.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Share of a unit cube about the origin that lies where normal . x < distance.
double share_of_cube(const Vec3& normal, double distance);

struct PieceShare {
    double mass = 0;             // [kg]
    Vec3 moment = Vec3::Zero();  // of it about the origin, at molding [kg m]
    double at_particles = 0;     // of each cell an eighth for each corner that it has [kg]
};

// Of each piece as its cells were molded: of one between pieces, by the planes of its cut points,
// what lies on the side of each.
std::vector<PieceShare> shares_of_pieces(const Aggregate& matter, const Pieces& pieces);

}  // namespace swage
