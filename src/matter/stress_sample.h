// SPDX-License-Identifier: GPL-3.0-or-later
// What the matter of a cell bears and has gone through, where that is known best.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "matter/cell_parts.h"

namespace swage {

// Of a cell, of each of the materials of a cell of two, and of each group of corners of one that is
// no longer whole.
struct StressSample {
    CellId cell = -1;
    CornerMask corners = kAllCorners;  // that it is of
    std::uint8_t material = 0;         // as cell_material
    bool sound = true;                 // as cell_is_sound(); else it is of what springs still bear
    // At molding, in cells from the lattice's origin: the centroid; of springs the cell's middle.
    Vec3 place = Vec3::Zero();
    double volume = 0;  // in cells
    // Cauchy's, xx, yy, zz, xy, yz, zx [Pa]: of what is sound along axes that turn with it, so that
    // neighbours in a bent body can be compared; else along the world's.
    std::array<double, 6> stress{};
    double plastic_strain = 0;
    double yields_at = 0;  // equivalent stress, now [Pa]; infinite: it never does
    // E times the strain at which it breaks, or would [Pa]; likewise.
    double breaks_at = std::numeric_limits<double>::infinity();
};

}  // namespace swage
