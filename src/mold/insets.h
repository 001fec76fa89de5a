// SPDX-License-Identifier: GPL-3.0-or-later
// Other materials inside a body: which cells they fill, wholly or in part.
#pragma once

#include <vector>

#include "mold/mold.h"
#include "mold/shares.h"

namespace swage {

// Sets inset, cell_material and mixed_cell of a body whose cells are filled. What of an inset lies
// outside is left out, and told in `findings`. Throws InsetError when an inset is no solid, or
// fills nothing. NOTE: a cell holds two materials at most; a third and less goes to the two with
// most.
void place_insets(const std::vector<Inset>& insets, const std::vector<CellLayer>& layers,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings);

}  // namespace swage
