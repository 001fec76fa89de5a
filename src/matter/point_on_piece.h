// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/point_side.h"

namespace swage {

// As carriage_on_side() has it, of a point part of whose patch lies on this piece: by the corners
// that its cell has of that. Where it has none, as that has it.
PointCarriage carriage_on_piece(const Aggregate& matter, std::size_t point, const Pieces& pieces,
                                int piece);

}  // namespace swage
