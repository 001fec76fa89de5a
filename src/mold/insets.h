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
// `body`: the surface that these layers are of, where insets may reach out of it: it is not told,
// and of a cell that the body fills in part they have no more than lies in both. NOTE: else what
// reaches out of such a cell counts as if it did not.
void place_insets(const std::vector<Inset>& insets, const std::vector<CellLayer>& layers,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings,
                  const TriMesh* body = nullptr);

}  // namespace swage
