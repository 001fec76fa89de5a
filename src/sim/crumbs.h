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

// Of each piece of the matter, whether it is a crumb; then whether it is one or two particles, or
// several in a row: nothing tells how such a one turns.
std::vector<char> find_crumbs(const Pieces& pieces);
std::vector<char> find_unturned(const Pieces& pieces, const Aggregate& matter);

// Of what is planned the marked pieces stay with one side that they would be cut from, that which
// holds them by most; with both they would join them. `pieces`: of the matter with all of the plan
// severed.
void keep_pieces(const Pieces& pieces, const std::vector<char>& is_kept,
                 std::deque<std::vector<SeverEvent>>& plan);

}  // namespace swage
