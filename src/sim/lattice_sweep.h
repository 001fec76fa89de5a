// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all connections of a lattice: forces of the spring-damper law with
// connection-wise yield.
#pragma once

#include <limits>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Constants of the sweep, derived once from material and spacing.
struct LatticeLaw {
    double stiffness;    // of a full connection [N/m]
    double damping = 0;  // of a full connection [N s/m]; 0 in quasi-static relaxation
    double yield_strain_edge = std::numeric_limits<double>::infinity();
    double yield_strain_diagonal = std::numeric_limits<double>::infinity();
    bool yields() const { return yield_strain_edge < std::numeric_limits<double>::infinity(); }
};
LatticeLaw lattice_law(const Aggregate& matter);

// The lattice cut into slabs of particles by its size alone, so that the order of all sums, and so
// every bit of the result, is the same for any number of threads.
class LatticeSweep {
  public:
    explicit LatticeSweep(const Aggregate& matter);

    // force = sum of the connections' forces on each particle [N]. Plastic strain is returned from
    // its committed value and left untouched. Velocities are read only when the law has damping.
    // Returns the power that the dashpots take [W].
    double forces(const Aggregate& matter, const LatticeLaw& law, Vec3Array& force);

  private:
    struct Slab {
        std::size_t span_begin, span_end;
        ParticleId begin, end;  // lower ends of its connections
        ParticleId reach;       // one past the highest upper end
        Vec3Array part;         // forces on begin ... reach
        double damping_power;   // [W]
    };
    std::vector<Slab> slab_;
};

// Remembers the plastic flow of a converged state; returns the work it dissipated [J].
double commit_plastic(Aggregate& matter, const LatticeLaw& law);

// Elastic energy stored in the connections [J].
double elastic_energy(const Aggregate& matter, const LatticeLaw& law);

// For each particle a stiffness [N/m] such that no motion of the lattice is faster than the fastest
// of these on their own masses: w_max^2 <= max(bound / mass). Zero without connections.
std::vector<double> stiffness_bound(const Aggregate& matter, const LatticeLaw& law);

}  // namespace swage
