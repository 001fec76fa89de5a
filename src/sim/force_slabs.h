// SPDX-License-Identifier: GPL-3.0-or-later
// Forces found slab by slab and added up in the order of the slabs, so that the order of all sums,
// and with it every bit of the result, is the same for any number of threads.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct ForceSlab {
    ParticleId begin = 0, reach = 0;  // the particles that it may push: begin ... reach - 1
    Vec3Array part;                   // forces on these [N]

    void clear();
};

using ForceSlabs = std::vector<ForceSlab>;

// force = sum of the slabs' parts.
void sum_slabs(const ForceSlabs& slabs, std::size_t particles, Vec3Array& force);

// Spans of connections, cut by the lattice's size alone; part: for the particles that each may
// push.
struct SpanSlab {
    std::size_t begin, end;
};
std::vector<SpanSlab> span_slabs(const Aggregate& matter, ForceSlabs& part);

// Rows of cells that add their forces in place: to the particles begin ... end - 1 of the result,
// which no other slab writes. What they give to particles behind waits in the seam.
struct CellSlab {
    std::size_t run_begin, run_end;  // cell runs
    ParticleId begin, end, reach;    // pushes particles up to reach - 1
    Vec3Array seam;                  // forces on end ... reach - 1 [N], and kSeamRoom behind
};
inline constexpr int kSeamRoom = 8;

std::vector<CellSlab> cell_slabs(const Aggregate& matter);

// Adds the seams, in the order of the slabs, when all slabs are done.
void add_seams(const std::vector<CellSlab>& slabs, Vec3Array& force);

}  // namespace swage
