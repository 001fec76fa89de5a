// SPDX-License-Identifier: GPL-3.0-or-later
// Forces found slab by slab: the lattice is cut by its size alone and seams are added in the order
// of the slabs, so that the order of all sums, and with it every bit of the result, is the same for
// any number of threads.
#pragma once

#include <span>
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

// The lattice's runs of cells, or their pieces of one material each where there are several.
class CellPieces {
  public:
    CellPieces(const Aggregate& matter, const std::vector<RowSlab>& slabs);  // of cell_slabs()

    const std::vector<CellRun>& all(const Aggregate& matter) const {
        return piece_.empty() ? matter.lattice.cell_run : piece_;
    }
    // The first of a slab's; behind the last slab, their number.
    std::size_t first_of(std::size_t slab) const { return first_[slab]; }
    std::span<const CellRun> of_slab(const Aggregate& matter, std::size_t slab) const {
        return std::span(all(matter)).subspan(first_[slab], first_[slab + 1] - first_[slab]);
    }

  private:
    std::vector<CellRun> piece_;
    std::vector<std::size_t> first_;
};

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
