// SPDX-License-Identifier: GPL-3.0-or-later
// Of pieces that blades have left no whole cell of, so that they meet tools and whole cells, but
// not each other (matter/touch_points.h).
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"
#include "sim/settings.h"

namespace swage {

// Of each of these bodies of which two such pieces or more hold a hundredth of the mass, where
// `sim` has pieces meet: that. What breaks goes to crumbs by itself, and nothing is said of it.
std::vector<std::string> thin_pieces_notes(const std::vector<WorkPiece>& bodies,
                                           const SimSettings& sim);

}  // namespace swage
