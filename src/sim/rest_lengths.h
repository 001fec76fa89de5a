// SPDX-License-Identifier: GPL-3.0-or-later
// The lengths that a cell's connections have where the cell is at rest after what it has flowed.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

using SlotLengths = std::array<double, kCellConnectionCount>;  // by kCellConnection [m]

// Mechanics of cells (laws/cell_rest.h). `mixed`: the cell's, or null; of two materials, where what
// both have flowed is without force along the connection, as sim/connection_shares.h lays them.
SlotLengths rest_lengths(const Aggregate& matter, CellId cell, const MixedCell* mixed);

// What a flow adds to the logarithm of a connection's rest length, times the share of the
// connection that is the cell's: all of a connection add up to its growth times its weight.
struct RestGrowth {
    using IsPlain = RestGrowth;
    ParticleId lower;
    float by;
};
// By direction.
using RestGrowths = std::array<std::vector<RestGrowth>, kForwardCount>;
// Slab by slab of the sweep over cells, then of what is beside it.
using SlabGrowths = std::vector<RestGrowths>;

}  // namespace swage
