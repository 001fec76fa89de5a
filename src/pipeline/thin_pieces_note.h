// SPDX-License-Identifier: GPL-3.0-or-later
// Of pieces that blades have left no whole cell of, so that in equilibria they meet by their
// particles alone (matter/touch_points.h): others, up to half a cell deep in them, and not each
// other.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"
#include "sim/settings.h"

namespace swage {

// Of each of these bodies of which such pieces hold a hundredth of the mass, where `sim` has pieces
// meet and come to rest: that. What breaks goes to crumbs by itself, and nothing is said of it.
std::vector<std::string> thin_pieces_notes(const std::vector<WorkPiece>& bodies,
                                           const SimSettings& sim);

}  // namespace swage
