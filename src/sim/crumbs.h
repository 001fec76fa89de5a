// SPDX-License-Identifier: GPL-3.0-or-later
// Crumbs: pieces of fewer particles than one cell has. No cut should leave any.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "matter/aggregate.h"
#include "sim/sever.h"

namespace swage {

std::ptrdiff_t particles_in_crumbs(const Pieces& pieces);

// What would fall off as a crumb stays with one side that it is cut from, that which held it by
// most; with both it would join them. `cut`: the matter with all of the plan severed.
void keep_crumbs(const Aggregate& cut, std::deque<std::vector<SeverEvent>>& plan);
// The same for some of its pieces, crumbs or not.
void keep_pieces(const Pieces& pieces, const std::vector<char>& crumb,
                 std::deque<std::vector<SeverEvent>>& plan);

}  // namespace swage
