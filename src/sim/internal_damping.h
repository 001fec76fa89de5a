// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice's internal damping in explicit steps: branches of springs and dashpots beside each
// connection (laws/internal_damping.h), and what they remember.
#pragma once

#include <vector>

#include "laws/internal_damping.h"
#include "matter/aggregate.h"
#include "sim/lattice_sweep.h"

namespace swage {

// The slowest swing to be damped as the material says: about that of the body held at one end.
double slowest_frequency(const Aggregate& matter);  // [rad/s]

class InternalDamping {
  public:
    // `highest`: angular frequency of the lattice [rad/s].
    InternalDamping(const Aggregate& matter, double highest);

    bool acts() const { return branches_.count > 0; }
    const DampingBranches& branches() const { return branches_; }

    // A step of this length [s], for LatticeForces::find(): 0 to leave the branches as they are.
    // `sweep` is the one that takes it.
    BranchStep step(const LatticeSweep& sweep, double duration);

    double stored_energy(const Aggregate& matter, const LatticeSweep& sweep) const;  // [J]

  private:
    DampingBranches branches_;
    // Tension over stiffness and length, as LatticeSweep keeps it.
    std::vector<float> strain_;
};

}  // namespace swage
