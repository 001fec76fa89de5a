// SPDX-License-Identifier: GPL-3.0-or-later
// What the corners of a cell are to each other once some of its connections are gone.
#pragma once

#include <array>
#include <cstdint>

#include "matter/aggregate.h"

namespace swage {

using CornerMask = std::uint8_t;  // a bit for each corner of a cell
inline constexpr CornerMask kAllCorners = 0xff;

// For each corner the corners that hang together with it by connections within the cell. Every
// entry is kAllCorners in a whole cell.
using CornerGroups = std::array<CornerMask, 8>;
CornerGroups corner_groups(const Aggregate& matter, const std::array<ParticleId, 8>& corner);
// As if nothing had broken by load: what blades have left together.
CornerGroups corner_groups_of_cut(const Aggregate& matter, const std::array<ParticleId, 8>& corner);
// Whether all of them hang together, be it not by every connection (as of cell_is_whole).
bool corners_hang_together(const Aggregate& matter, const std::array<ParticleId, 8>& corner);

// The first of `corners` that weighs most; -1: there is none.
int heaviest_corner(const std::array<double, 8>& weight, CornerMask corners);

}  // namespace swage
