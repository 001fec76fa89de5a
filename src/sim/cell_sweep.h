// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all cells of a lattice: forces of the cell law (laws/cell.h), eight cells of a row
// at a time.
#pragma once

#include <vector>

#include "laws/cell_moduli.h"
#include "matter/aggregate.h"
#include "sim/force_slabs.h"
#include "sim/loose_springs.h"

namespace swage {

class CellSweep {
  public:
    explicit CellSweep(const Aggregate& matter);

    // Cells that are not whole any more carry nothing from now on.
    void cells_changed(const Aggregate& matter);
    const std::vector<float>& carried_fill() const { return fill_; }  // 0: not whole

    // force = sum of the cells' forces on each particle [N].
    void forces(const Aggregate& matter, Flow flow, Vec3Array& force);

    // Remembers the flow of a converged state; returns the work that it took [J].
    double commit(Aggregate& matter) const;

    double elastic_energy(const Aggregate& matter) const;  // [J]

    // Adds to each particle a stiffness [N/m] such that no motion is faster than the fastest of
    // these on their own masses.
    void add_stiffness_bound(const Aggregate& matter, std::vector<double>& bound) const;

    bool yields() const { return yields_; }

    // Runs of the last sweep in which a cell may have lost half of its volume (sim/cell_volume.h),
    // slab by slab.
    const std::vector<std::vector<const CellRun*>>& crushed_runs() const { return crushed_; }

  private:
    CellModuli law_;
    bool yields_, rubber_;
    std::vector<float> fill_;
    std::vector<CellSlab> slab_;
    // By batches of eight cells of a run: whether all are full and whole, or where their fills and
    // centroids, -1 to 1 in the cell, begin in share_.
    std::vector<std::int32_t> batch_;
    std::vector<float> share_;
    std::vector<std::size_t> slab_batch_;  // first batch of each slab
    std::vector<std::vector<const CellRun*>> crushed_;
};

}  // namespace swage
