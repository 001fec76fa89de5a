// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all cells of a lattice: forces of the cell law (laws/cell.h), eight cells of a row
// at a time.
#pragma once

#include <vector>

#include "laws/cell_moduli.h"
#include "matter/aggregate.h"
#include "sim/force_slabs.h"

namespace swage {

enum class Flow {
    trial,  // what yields flows on from the committed history
    none,   // nothing flows further
};

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

  private:
    struct Slab {
        std::size_t run_begin, run_end;  // cell runs
    };
    CellModuli law_;
    bool yields_, rubber_;
    std::vector<float> fill_;
    std::array<std::vector<float>, 3> at_;  // centroid of the material, -1 to 1 in the cell
    std::vector<Slab> slab_;
    ForceSlabs part_;
};

}  // namespace swage
