// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies in motion with real masses, in blocks of steps of one length, by one of three formulas.
// sim/motion_guard.h watches the blocks; one that goes wrong is taken back and tried again. A step
// is also short enough that nothing goes far in it, however fast.
//
// Solver::explicit_steps: symplectic Euler,
//
//     v += dt f(x) / m,   x += dt v,
//
// its speeds half a step after its places (a half kick begins and ends each block of steps, so that
// both stand at one time there, and begins what is woken within one; Stoermer and Verlet's method,
// of second order). All bodies take the same step. For one swing of angular frequency w, one step
// maps (x, v dt) by a matrix of determinant 1 and trace 2 - (w dt)^2: both eigenvalues stay on the
// unit circle, and the swing bounded, while w dt < 2. Damping ratio zeta at w narrows that to w dt
// < 2 (sqrt(1 + zeta^2) - zeta); explicit_step() takes the fastest swing of the fastest body.
// Contact and grip points are kept below a quarter of what their carriers can follow in one step.
//
// Solver::euler, as the papers have it: x += dt v, v += dt f(x) / m, both of the old state. The
// trace of the map is 2 and its determinant 1 + (w dt)^2: every undamped swing grows, at any step.
// With damping the determinant is 1 - 2 zeta w dt + (w dt)^2, so the swing stays bounded while w dt
// < 2 zeta, which is the step it takes: a share zeta or so of the symplectic one.
//
// Solver::implicit_steps: sim/implicit_step.h; a quarter of a leg a step, of which a frame is one
// or more (machines/legs.h), where no tool is in reach. Explicit steps that go wrong however short
// pass on to it too, where it can move the body.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/implicit_step.h"
#include "sim/motion_guard.h"
#include "sim/move_outcome.h"
#include "sim/moving_bodies.h"
#include "sim/settings.h"

namespace swage {

class BlockSolver {
  public:
    BlockSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                const SimSettings& settings);

    // Is given up when the guard finds something wrong even in the shortest steps; the matter is
    // then as it was at the last block that was right.
    MoveOutcome advance(const Drive& from, const Drive& to);
    void masses_changed(std::size_t body, const std::vector<double>& was);  // as MovingBody's
    // A blade has severed connections of this body. Returns what contacts with tools and grips held
    // by what is gone [J]; with other bodies that counts as damped in the next move.
    double connections_changed(std::size_t body, const Drive& now);
    double elastic_energy(std::size_t body) { return bodies_[body].elastic_energy(); }  // [J]
    const LoadSet& pushes(std::size_t body) const { return bodies_[body].pushes(); }

    BodyContact& contact() { return bodies_.contact(); }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(bodies_, step_, energy_, started_, share_, good_blocks_, halvings_, steps_,
           rescued_blocks_);
        for (std::size_t b = 0; b < implicit_.size(); ++b) implicit_[b].visit(io, bodies_[b]);
        if constexpr (Io::kReads) limit_stiffness();
    }

  private:
    struct Way {
        const Drive &from, &to;
        Drive at(double time) const {
            return time >= to.time
                       ? to
                       : drive_between(from, to, (time - from.time) / (to.time - from.time));
        }
    };
    double longest_step(const Way& way, const Drive& begin);
    bool is_implicit() const {
        return settings_.solver == Solver::implicit_steps || rescued_blocks_ > 0;
    }
    bool has_half_kicks() const {
        return settings_.solver == Solver::explicit_steps && rescued_blocks_ == 0;
    }
    // That the speeds go on by from where places and speeds stand at one time [s].
    double first_step(double dt) const { return has_half_kicks() ? 0.5 * dt : dt; }
    // So often halved that cells may turn inside out.
    bool may_crush() const;
    // Moves one body on by a step of a block; returns the longest way of any particle [m].
    double move(std::size_t body, const Drive& now, double dt, BodyOutcome& outcome);
    struct Block;
    Block next_block(const Way& way, const Drive& begin);
    void start_books(const std::vector<Stored>& before, bool again, MoveOutcome& outcome);
    Finding take(const Way& way, const Block& block, MoveOutcome& outcome);
    bool energy_holds(const Block& block, const std::vector<Stored>& before,
                      const std::vector<Stored>& after, const std::vector<BodyOutcome>& so_far,
                      const std::vector<BodyOutcome>& now);
    void keep(const Block& block, MoveOutcome& outcome);
    std::string take_back(const Block& block, const Finding& found,
                          const std::vector<BodyOutcome>& so_far, MoveOutcome& outcome);
    bool can_be_rescued() const;
    double step_of(std::size_t body) const;  // that it alone would allow at first [s]
    void limit_stiffness();                  // of contacts, for its steps

    const Apparatus& apparatus_;
    SimSettings settings_;
    MovingBodies bodies_;
    EnergyGuard energy_;
    bool started_ = false;
    double step_;          // [s]
    double share_ = 1;     // of the step that is taken now: halved where the guard asked
    int good_blocks_ = 0;  // since then
    int halvings_ = 0;     // of this block
    long steps_ = 0;       // of the stage
    std::vector<ImplicitStep> implicit_;
    int rescued_blocks_ = 0;  // of implicit steps yet to come where explicit ones went wrong
};

}  // namespace swage
