// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice's internal damping in motion, but for implicit steps: branches of springs and
// dashpots beside each connection (laws/internal_damping.h), and what they remember; a set of
// branches for each of the damping ratios of a body's materials.
#pragma once

#include <vector>

#include "laws/internal_damping.h"
#include "matter/aggregate.h"
#include "sim/lattice_forces.h"

namespace swage {

// The slowest swing to be damped as the material says: about that of the body held at one end.
double slowest_frequency(const Aggregate& matter);  // [rad/s]

double largest_damping_ratio(const Aggregate& matter);  // of its materials

class InternalDamping {
  public:
    // `highest`: angular frequency of the lattice [rad/s]. Matter that comes from an earlier stage
    // goes on with the branches it has.
    InternalDamping(const Aggregate& matter, double highest);

    bool acts() const { return !branches_.empty(); }
    // Adds what the branches are as stiff as at most, as if they were springs [N/m].
    void add_stiffness_bound(const Aggregate& matter, std::vector<double>& bound) const;

    // A step of this length [s], for LatticeForces::find(): 0 to leave the branches as they are.
    // `lattice` is the one that takes it.
    std::vector<BranchStep> step(Aggregate& matter, LatticeForces& lattice, double duration);
    // Where LatticeForces::commit() is to say how rest lengths have grown.
    SlabGrowths* growths() { return &growths_; }
    void let_go(Aggregate& matter);  // all branches carry nothing from now on

    double stored_energy(const Aggregate& matter, LatticeForces& lattice) const;  // [J]

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(growths_, taken_, grown_);
    }

  private:
    // What flowed takes the branches along in the next step: then they have pulled as they were
    // when it did, and the books are of second order.
    void take_growths(const Aggregate& matter);

    std::vector<DampingBranches> branches_;  // of damped_materials()
    SlabGrowths growths_, taken_;            // to come, and as they are in grown_
    RestStrains grown_;                      // all else is 0
};

}  // namespace swage
