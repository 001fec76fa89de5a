// SPDX-License-Identifier: GPL-3.0-or-later
// What loads and gravity leave over, all in all, along the ways that grips leave a piece free:
// patches of a surface are as fine as the cells, and equilibria would go any way for what these are
// short of balance.
#pragma once

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/gripped_pieces.h"

namespace swage {

// Of all loads and gravity on a piece: what they are short of balance by is no more.
inline constexpr double kLittlePush = 0.05;

// Takes it off where it is no more. `push`: of loads and gravity on each particle [N].
void add_steadying_forces(const Aggregate& matter, const Apparatus& apparatus,
                          const GrippedPieces& gripped, const Drive& now, const Vec3Array& push,
                          Vec3Array& force);

}  // namespace swage
