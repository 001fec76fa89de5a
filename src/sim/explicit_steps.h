// SPDX-License-Identifier: GPL-3.0-or-later
// Explicit steps with real masses: symplectic Euler,
//
//     v += dt f(x, v) / m,   x += dt v.
//
// Stable while dt < 2 / w (sqrt(1 + zeta^2) - zeta), w the lattice's highest angular frequency and
// zeta its damping ratio there; w^2 <= max(bound / m) of stiffness_bound(), with all branches of
// the damping as if they were springs. Contact and grip points are kept below a quarter of what
// their carriers can follow in one step.
#pragma once

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/contact_set.h"
#include "sim/internal_damping.h"
#include "sim/lattice_forces.h"
#include "sim/load_set.h"
#include "sim/move_outcome.h"
#include "sim/settings.h"
#include "sim/surface_drag.h"

namespace swage {

// The longest stable step times the settings' safety [s].
double explicit_step(const Aggregate& matter, const SimSettings& settings);

class ExplicitSolver {
  public:
    ExplicitSolver(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings);

    // Throws Error(stopped) when the state is not finite even after halving the step; the matter is
    // then as it was before the move.
    MoveOutcome advance(const Drive& from, const Drive& to);
    void connections_changed();
    // In the lattice and in the branches of its damping [J].
    double elastic_energy() {
        return lattice_.elastic_energy(matter_) +
               (damping_.acts() ? damping_.stored_energy(matter_) : 0);
    }
    const LoadSet& pushes() const { return pushes_; }

  private:
    bool steps(const Drive& from, const Drive& to, double dt, MoveOutcome& outcome);

    Aggregate& matter_;
    const Apparatus& apparatus_;
    SimSettings settings_;
    LatticeForces lattice_;
    InternalDamping damping_;
    ContactSet contacts_;
    LoadSet pushes_;
    double step_;
    SurfaceDrag drag_;
    Vec3Array force_;
    std::vector<LoadSum> load_;
};

}  // namespace swage
