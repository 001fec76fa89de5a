// SPDX-License-Identifier: GPL-3.0-or-later
// Of skins that are drawn around matter (skin/boundary.h): where they enclose more than it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"

namespace swage {

// Of one of these bodies whose boundary as it was made encloses a hundredth more or less than its
// matter: that, and why. Else empty.
std::string boundary_note(const std::vector<WorkPiece>& bodies, const WorkPiece& body);

// Of all that have one.
std::vector<std::string> boundary_notes(const std::vector<WorkPiece>& bodies);

}  // namespace swage
