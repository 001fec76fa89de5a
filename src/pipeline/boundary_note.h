// SPDX-License-Identifier: GPL-3.0-or-later
// Of skins that are drawn around matter (skin/boundary.h): where they enclose more than it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"

namespace swage {

// A sentence for each boundary that as it was made encloses a hundredth more or less than its
// matter.
std::vector<std::string> boundary_notes(const std::vector<WorkPiece>& bodies);

}  // namespace swage
