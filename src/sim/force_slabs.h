// SPDX-License-Identifier: GPL-3.0-or-later
// Forces found slab by slab: the lattice is cut by its size alone and seams are added in the order
// of the slabs, so that the order of all sums, and with it every bit of the result, is the same for
// any number of threads.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

inline constexpr int kSeamRoom = 8;

// Rows that add their forces in place: to the particles begin ... end - 1 of the result, which no
// other slab writes. What they give to particles behind waits in the seam.
struct RowSlab {
    std::size_t run_begin, run_end;  // of the sweep's runs
    ParticleId begin, end, reach;    // pushes particles up to reach - 1
    // Forces on end ... reach - 1 [N], with `room` more before and kSeamRoom behind.
    Vec3Array seam;
    int room = kSeamRoom;
};

// By the lattice's runs of cells.
std::vector<RowSlab> cell_slabs(const Aggregate& matter);

// Consecutive particles of one row, with the same offsets to their neighbours in the rows above.
struct SpringRun {
    int j, k;  // the row
    ParticleId first;
    int count;
    // Above the first one at (j + 1, k), (j, k + 1), (j + 1, k + 1) and (j - 1, k + 1); -1: none,
    // and then no connection leads there or past there. Where the row above begins further on, as
    // if it began there.
    std::array<ParticleId, 4> above;
    std::array<ParticleId, 4> met;  // the first that is there of each
};
std::vector<SpringRun> spring_runs(const Lattice& lattice);
std::vector<RowSlab> spring_slabs(const std::vector<SpringRun>& runs, std::size_t particles);

// Where a slab's forces go: component by component, the result's beginning, and the seam's place of
// the particle `end`. Clears the seam.
struct ForceRows {
    double* own[3];
    double* seam[3] = {};
};
ForceRows force_rows(RowSlab& slab, Vec3Array& force);

// Adds the seams, in the order of the slabs, when all slabs are done.
void add_seams(const std::vector<RowSlab>& slabs, Vec3Array& force);

}  // namespace swage
