// SPDX-License-Identifier: GPL-3.0-or-later
// Matter that hangs by a hinge. A cell that is cut or broken is plain springs, which bear no
// moment: what is joined to the rest by a line of such cells swings about it without any work, and
// has no equilibrium but the far one in which it hangs down.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/held_point.h"

namespace swage {

// Matter that whole cells join. A particle of no whole cell goes with what a connection joins it
// to, unless its connections and what holds points leave it free to move some way: it is by itself.
Pieces find_firm_pieces(const Aggregate& matter, const std::vector<HeldPoint>& held);

// Of these, such particles: a grip holds the mean of several, and not each. And what moves where
// others of the same piece do not, or otherwise, and all connections between them and what holds
// points let it: at the present positions, each of them rigid; never what is held itself. Of a
// piece of very many it is not asked.
std::vector<int> find_hanging(const Aggregate& matter, const Pieces& pieces, const Pieces& firm,
                              const std::vector<HeldPoint>& held);

}  // namespace swage
