// SPDX-License-Identifier: GPL-3.0-or-later
// Other materials inside a body: which cells they fill, wholly or in part.
#pragma once

#include <vector>

#include "mold/mold.h"
#include "mold/shares.h"

namespace swage {

// A body's closed surface, what its cells hold of it, and what of that came from their neighbours.
struct MoldedSurface {
    const TriMesh& mesh;
    const std::vector<CellLayer>& layers;
    const std::vector<SliverMove>& moves;
};

// Sets inset, cell_material and mixed_cell of a body whose cells are filled. What of an inset lies
// outside is left out, and told in `findings` unless it may reach out. Throws InsetError when an
// inset is no solid, or fills nothing. NOTE: a cell holds two materials at most; a third and less
// goes to the two with most.
void place_insets(const std::vector<Inset>& insets, const MoldedSurface& body,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings,
                  bool may_reach_out);

}  // namespace swage
