// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all connections of a lattice: forces of the spring-damper law.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/force_slabs.h"

namespace swage {

// Constants of the sweep, derived once from material and spacing.
struct LatticeLaw {
    double stiffness;    // of a full connection [N/m]
    double damping = 0;  // of a full connection [N s/m]; 0 in quasi-static relaxation
};
LatticeLaw lattice_law(const Aggregate& matter);

// rest_length / reference_length - 1 of every connection, by direction and lower particle.
using RestStrains = std::array<std::vector<float>, kForwardCount>;

// The lattice cut into slabs of particles by its size alone, so that the order of all sums, and so
// every bit of the result, is the same for any number of threads.
class LatticeSweep {
  public:
    explicit LatticeSweep(const Aggregate& matter);

    // force = sum of the connections' forces on each particle [N], with the given rest strains or
    // else the committed ones. Velocities are read only when the law has damping.
    // Returns the power that the dashpots take [W].
    double forces(const Aggregate& matter, const LatticeLaw& law, const RestStrains* rest,
                  Vec3Array& force);

  private:
    ForceSlabs part_;
    std::vector<SpanSlab> slab_;
    std::vector<double> damping_power_;  // a slab [W]
};

// Elastic energy stored in the connections [J].
double elastic_energy(const Aggregate& matter, const LatticeLaw& law);

// For each particle a stiffness [N/m] such that no motion of the lattice is faster than the fastest
// of these on their own masses: w_max^2 <= max(bound / mass). Zero without connections.
std::vector<double> stiffness_bound(const Aggregate& matter, const LatticeLaw& law);

}  // namespace swage
