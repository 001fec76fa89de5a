// SPDX-License-Identifier: GPL-3.0-or-later
// One body in motion by explicit steps: its matter, and all that acts on it except other bodies.
#pragma once

#include <memory>

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

// The longest stable step times the settings' safety [s]; dt < 2 / w (sqrt(1 + zeta^2) - zeta), w
// the lattice's highest angular frequency and zeta its damping ratio there; w^2 <= max(bound / m)
// of stiffness_bound(), with all branches of the damping as if they were springs.
double explicit_step(const Aggregate& matter, const SimSettings& settings);

class MovingBody {
  public:
    // `number`: of the body, as grips and loads name it. The references must outlive it.
    MovingBody(Aggregate& matter, int number, const Apparatus& apparatus,
               const SimSettings& settings);

    double stable_step() const { return step_; }  // [s], with the settings' safety
    // No contact is stiffer than what its carriers can follow in steps of this length [s].
    void limit_stiffness(double step) { contacts_.limit_stiffness(matter_, step); }

    // A frame begins.
    void start(const Drive& from) { pushes_.start(matter_, from); }
    void find_candidates(const Drive& now);
    // Steps from here, and after the last of them.
    void begin_steps(const Drive& from, BodyOutcome& outcome);
    void end_steps(BodyOutcome& outcome);

    // Forces at the present positions, at which a step of this length [s] has just ended and one
    // toward `now` begins. What flows and breaks there does so for good.
    void find_forces(const Drive& before, const Drive& now, double step, BodyOutcome& outcome);
    // Symplectic Euler: v += dt f / m, x += dt v. False: it is not finite any more.
    bool move(const Drive& now, double step);
    // The step is kept.
    void commit(const Drive& before, const Drive& now, BodyOutcome& outcome);
    // The farthest any particle has gone since the candidates were found [m].
    double travel() const { return farthest_; }
    double tool_travel(const Drive& before, const Drive& now) const {
        return contacts_.travel(matter_, before, now);
    }

    void connections_changed() { lattice_.connections_changed(matter_); }
    // In the lattice and in the branches of its damping [J].
    double elastic_energy();

    Aggregate& matter() { return matter_; }
    const Aggregate& matter() const { return matter_; }
    Vec3Array& force() { return force_; }
    const LoadSet& pushes() const { return pushes_; }
    const std::vector<LoadSum>& load() const { return load_; }  // by tool, then grip
    bool drag_is_held() const { return drag_.is_held(); }

    // All that a step changes.
    struct State;
    std::shared_ptr<const State> save() const;
    void restore(const State& state);

  private:
    double branch_energy();
    void find_inner_forces(double step, BodyOutcome& outcome);
    void remember(BodyOutcome& outcome);

    Aggregate& matter_;
    LatticeForces lattice_;
    InternalDamping damping_;
    ContactSet contacts_;
    LoadSet pushes_;
    double step_;
    SurfaceDrag drag_;
    bool remembers_;            // something can flow or break
    Vec3Array force_, listed_;  // listed: positions when the candidates were found
    double farthest_ = 0;
    std::vector<LoadSum> load_;
};

}  // namespace swage
