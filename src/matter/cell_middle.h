// SPDX-License-Identifier: GPL-3.0-or-later
// Where a cell is now.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// The mean of its corners [m].
inline Vec3 cell_middle(const Aggregate& matter, CellId cell) {
    Vec3 sum = Vec3::Zero();
    for (ParticleId p : matter.lattice.cell_corners(cell)) sum += matter.particle_position.at(p);
    return sum / 8;
}

}  // namespace swage
