// SPDX-License-Identifier: GPL-3.0-or-later
// What steps change of a body of matter, to go back to.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Each as in Aggregate. What its materials never change is not kept: of what only swings there are
// places, speeds and the jumps in cells of two materials, of what yields or breaks history too, and
// of what breaks its connections whole.
struct MatterState {
    Vec3Array particle_position, particle_velocity;
    std::array<ConnectionArrays, kForwardCount> connection;
    std::vector<char> cell_cracked;
    std::vector<CellSet> cell_set;
    CellHistories cell_history;
    CellBackStrains cell_back;
    std::array<std::vector<float>, kCellConnectionCount> cell_plastic;
    std::vector<MixedCell> mixed_cell;

    void save(const Aggregate& matter);
    void restore(Aggregate& matter) const;
};

}  // namespace swage
