// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all cells of a lattice: forces of the cell law (laws/cell.h), eight cells of a row
// at a time.
#pragma once

#include <vector>

#include "laws/cell_moduli.h"
#include "matter/aggregate.h"
#include "sim/flow.h"
#include "sim/force_slabs.h"
#include "sim/material_laws.h"
#include "sim/mixed_cells.h"
#include "sim/rest_lengths.h"
#include "sim/turned_cell.h"

namespace swage {

// Runs, slab by slab.
using SlabRuns = std::vector<std::vector<const CellRun*>>;

class CellSweep {
  public:
    explicit CellSweep(const Aggregate& matter);

    // Cells with such a strain are told from now on: of their material, or of a connection.
    void watch_strain(double onset) { onset_ = onset; }

    // Cells that are not whole any more carry nothing from now on. Adds those that have carried
    // until now to `turned`, where that is asked for.
    void cells_changed(const Aggregate& matter, std::vector<TurnedCell>* turned = nullptr);
    const std::vector<float>& carried_fill() const { return fill_; }  // 0: not whole

    // force = sum of the cells' forces on each particle [N].
    void forces(const Aggregate& matter, Flow flow, Vec3Array& force);

    // Remembers the flow of a converged state; returns the work that it took [J]. Adds to
    // `growths`, where it is asked for.
    double commit(Aggregate& matter, Forces found, SlabGrowths* growths) const;

    double elastic_energy(const Aggregate& matter) const;  // [J]

    // Adds to each particle a stiffness [N/m] such that no motion is faster than the fastest of
    // these on their own masses.
    void add_stiffness_bound(const Aggregate& matter, std::vector<double>& bound) const;

    // Runs of the last sweep with cells that may have lost half of their volume
    // (sim/cell_volume.h), and with cells that may have reached the strain that is watched, in
    // their order.
    const SlabRuns& crushed_runs() const { return crushed_; }
    std::vector<const CellRun*> strained_runs(const Aggregate& matter) const;

  private:
    const MaterialLaw& law_of(const Aggregate& matter, CellId cell) const {
        return law_[matter.material_number(cell)];
    }
    double energy_of(const Aggregate& matter, const CellRun& run, int n) const;  // of one cell [J]
    template <typename Act>
    double sum_of_runs(const Aggregate& matter, const SlabRuns* of, const Act& act) const;

    std::vector<MaterialLaw> law_;  // by material
    bool yields_;                   // any
    // What the sweep itself carries: cells of two materials are beside it.
    const std::vector<float>& swept() const { return swept_.empty() ? fill_ : swept_; }
    std::vector<float> fill_, swept_;
    std::vector<RowSlab> slab_;  // of the lattice's runs
    CellPieces pieces_;
    // By batches of eight cells of a piece: kWholeCells, or where their fills and centroids, -1 to
    // 1 in the cell, begin in share_.
    std::vector<std::int32_t> batch_;
    std::vector<float> share_;
    std::vector<std::size_t> slab_batch_;     // first batch of each slab
    SlabRuns crushed_, strained_, yielding_;  // yielding: may flow
    double onset_ = 0;                        // 0: no strain is watched
    MixedCells mixed_;
};

}  // namespace swage
