// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of a lattice of springs that flow, found and handed on several at a time.
#pragma once

#include <array>
#include <vector>

#include "laws/yield.h"
#include "matter/aggregate.h"
#include "sim/lattice_sweep.h"
#include "sim/rest_lengths.h"

namespace swage {

// Cells of a run side by side, some of which flow. Always of kLanes, whatever the width of the
// kernels: what meets on a connection is added in one order everywhere.
struct FlowingCells {
    using IsPlain = FlowingCells;
    std::array<ParticleId, 4> row;  // of the first: low ends of its four edges along x
    CellId first;
    int count;
    std::array<char, kLanes> flows;
    double d_alpha[kLanes];
    double grows[kCellConnectionCount][kLanes];  // of p_b

    ParticleId lower(int slot) const {
        const int corner = kCellConnection[slot].corner;
        return row[corner >> 1] + (corner & 1);
    }
};

// Logarithmic strains of all connections; each direction's are followed by kStrainsBehind, as
// batches read beyond the last.
using SpringStrains = std::array<std::vector<float>, kForwardCount>;
inline constexpr int kStrainsBehind = 2 * kLanes;

struct FlowSearch {
    const Aggregate& matter;
    const Yield& law;
    const SpringStrains& strain;
    const std::vector<char>& sound;  // by cell
};
// Of some runs, in their order.
void find_flowing(const FlowSearch& search, const CellRun* run, const CellRun* run_end,
                  std::vector<FlowingCells>& found);

// Rest strains with what flows on top.
void add_flow(const Aggregate& matter, const std::vector<FlowingCells>& flowing, RestStrains& rest);

// Gives the connections of flowing cells their rest strains for good; returns what that takes from
// their elastic energy, over stiffness and spacing squared: their tension times the growth. Adds to
// `growths`, where it is asked for.
double keep_flow(Aggregate& matter, const std::vector<FlowingCells>& flowing,
                 const SpringStrains& strain, const RestStrains& rest, RestGrowths* growths);

}  // namespace swage
