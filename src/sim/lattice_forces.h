// SPDX-License-Identifier: GPL-3.0-or-later
// The forces inside the matter by the mechanics that its material asks for, flow and guard
// included.
#pragma once

#include <memory>
#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_flow.h"
#include "sim/cell_sweep.h"
#include "sim/lattice_sweep.h"

namespace swage {

class LatticeForces {
  public:
    explicit LatticeForces(const Aggregate& matter);

    // Connections have been severed. A cell that has lost one is no cell any more; what it has left
    // acts as plain springs, with the plastic strain it had.
    void connections_changed(const Aggregate& matter);

    // Forces on every particle at the present positions [N].
    // Returns the number of cells that are inside out: they are stiffer than stiffness_bound()
    // says, by add_guard_stiffness().
    int find(const Aggregate& matter, Flow flow, Vec3Array& force);

    // Adds the forces of dashpots along all connections, `damping` [N s/m] of a full one; returns
    // the power that they take [W].
    double add_dashpots(const Aggregate& matter, double damping, Vec3Array& force);

    // Remembers the flow of a converged state; returns the work that it took [J].
    double commit(Aggregate& matter);

    double elastic_energy(const Aggregate& matter) const;  // [J]

    // What the cells carry, where forces are theirs alone and of one material; else null.
    const std::vector<float>* cells_alone() const {
        const bool alone = cells_ && loose_.empty() && cells_->one_material();
        return alone ? &cells_->carried_fill() : nullptr;
    }

    // For each particle a stiffness [N/m] such that no motion of the lattice is faster than the
    // fastest of these on their own masses: w_max^2 <= max(bound / mass). Zero for a loose
    // particle.
    std::vector<double> stiffness_bound(const Aggregate& matter) const;

  private:
    void add_loose(const Aggregate& matter, Vec3Array& force) const;

    struct LooseSpring {
        ParticleId lower, upper;
        double stiffness;    // [N/m]
        double rest_length;  // [m]
    };
    LatticeLaw spring_law_;
    LatticeSweep spring_sweep_;
    std::unique_ptr<CellFlow> spring_flow_;  // springs that yield
    std::unique_ptr<CellSweep> cells_;       // null: springs
    bool guarded_;
    std::vector<LooseSpring> loose_;  // of cells that are not whole
    Vec3Array extra_;
};

}  // namespace swage
