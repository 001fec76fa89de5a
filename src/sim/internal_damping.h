// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice's internal damping in explicit steps: branches of springs and dashpots beside each
// connection (laws/internal_damping.h), and what they remember.
#pragma once

#include <array>
#include <vector>

#include "laws/internal_damping.h"
#include "matter/aggregate.h"
#include "sim/force_slabs.h"

namespace swage {

// The slowest swing to be damped as the material says: about that of the body held at one end.
double slowest_frequency(const Aggregate& matter);  // [rad/s]

class InternalDamping {
  public:
    // `highest`: angular frequency of the lattice [rad/s].
    InternalDamping(const Aggregate& matter, double highest);

    bool acts() const { return branches_.count > 0; }
    const DampingBranches& branches() const { return branches_; }

    // A step of this length [s] has been made with the present velocities. Adds the forces of the
    // branches after it; returns the energy that they took during it [J].
    double add_forces(const Aggregate& matter, double step, Vec3Array& force);

    double stored_energy(const Aggregate& matter) const;  // in the branches [J]

  private:
    DampingBranches branches_;
    double stiffness_;  // of a full connection [N/m]
    // Tension over stiffness and length, by direction, branch and lower particle.
    std::array<std::array<std::vector<float>, kMostBranches>, kForwardCount> strain_;
    std::vector<SpanSlab> slab_;
    ForceSlabs part_;
    std::vector<double> taken_;  // [J], a slab
    Vec3Array extra_;
};

}  // namespace swage
