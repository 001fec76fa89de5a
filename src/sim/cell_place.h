// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point of space lies among a body's cells, each bent as its corners are.
#pragma once

#include <array>

#include "sim/contact_side.h"

namespace swage {

struct CellPlace {
    CellId cell;
    Vec3i site;
    std::array<ParticleId, 8> corner;
    Vec3 place = Vec3::Constant(0.5);  // in the cell, 0 to 1
};

// Of a place in a cell, by corner.
std::array<double, 8> trilinear_weights(const Vec3& place);

// Walks from the cell it was last in to the one that holds x, where `gradient` is dx / dplace [m];
// false where there is none: `at` is then the last cell on the way.
bool find_place(const ContactSide& onto, const Vec3& x, CellPlace& at, Mat3& gradient);

}  // namespace swage
