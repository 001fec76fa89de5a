// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies in motion by steps that their energy chooses (Joukhadar and Laugier, S0.7 and S0.8). With
// the acceleration carried on in a straight line over the step,
//
//     v += dt ((1 + r/2) a - r/2 a')
//     x += dt v + dt^2/2 ((1 + r/3) a - r/3 a'),      r = dt / dt',
//
// a' the acceleration a step of dt' earlier. Where the energy of a group of bodies, work done on it
// taken off, rises over a step by more than 1e-9 of all that was put in, the step is taken back and
// halved; else the next is half as long again. Groups that nothing can bring together within the
// frame take their own steps.
//
// NOTE: what a drive does to a body that has not moved yet costs no energy: a grip's spring that is
// drawn out over a step holds just the work that drew it, and a load moves nothing until the next
// step. So while anything that acts on a body changes, no step is longer than half a stable one,
// nor takes what comes near on by more than a part of a spacing; the first is a stable one.
//
// Stability: for one undamped swing of angular frequency w the energy grows by (w dt)^4 / 4 of
// itself a step (the Adams-Bashforth formula of second order), so steps that keep it have
// w dt < (4e-9)^(1/4) = 0.008; damping lengthens them, and a body that does not swing takes any.
//
// NOTE: S0.8 asks only that energy does not rise. Steps of that kind lost up to nine tenths of a
// bouncing body's energy to nothing, and hid what they gained behind what damping took; here the
// books of a step must also close, to 1e-6 of what was put in. Either bound grows by what places
// are rounded to.
// NOTE: S0.8 lets the step grow after each success, which takes back 3 tries of 8 where the best
// step stays the same: tries/steps is 1.58. The step after one that was taken back keeps its
// length here, which gives 1.33.
// NOTE: S0.7's beta and gamma stand for r = 1; they are r/2 and r/3 where the step changes. Forces
// that depend on speed are told the mean one of the step before: with the speed at its end, as the
// paper has it, they are right to the first order only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/body_contact.h"
#include "sim/motion_guard.h"
#include "sim/move_outcome.h"
#include "sim/moving_body.h"

namespace swage {

// The formula: goes on by a step from forces that were found. `before`: the accelerations a step of
// `last` [s] earlier, if there are any; afterwards those of now.
void carry_on(MovingBody& body, double step, double last, Vec3Array& before);
// The forces there, after a step from those places.
void find_forces_of_step(MovingBody& body, const Drive& now, const Vec3Array& from, double step,
                         BodyOutcome& outcome);

class EnergySteps {
  public:
    struct Tried {
        double time, step;  // that it began at, and its length [s]
        double astray;      // energy that came from nowhere [J]
        bool kept;
    };

    EnergySteps(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                const SimSettings& settings);

    // Given up where no step is short enough: a single group has then got to where its steps were
    // last right, several are all back at `from`.
    MoveOutcome advance(const Drive& from, const Drive& to);
    void masses_changed(std::size_t body, const std::vector<double>& was) {  // as MovingBody's
        mover_[body].body.masses_changed(was);
    }
    double connections_changed(std::size_t body, const Drive& now);  // as BlockSolver's
    double elastic_energy(std::size_t body) { return mover_[body].body.elastic_energy(); }
    const LoadSet& pushes(std::size_t body) const { return mover_[body].body.pushes(); }
    BodyContact& contact() { return contact_; }
    // Writes down every step from now on.
    void record(std::vector<Tried>* tried) { tried_ = tried; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        for (Mover& one : mover_) io(one);
        io(contact_, by_contact_, steps_);
    }

  private:
    struct Mover {
        MovingBody body;
        MovingBody::State state{};
        Vec3Array before{};           // acceleration a step earlier; empty: none
        double step = 0;              // [s] to try next; 0: not moved yet
        double last_step = 0;         // [s] of the last step kept
        bool was_taken_back = false;  // the step before was taken back
        double budget = 0;            // energy ever put in [J]

        template <typename Io>
        void visit(Io& io) {
            io(body, before, step, last_step, was_taken_back, budget);
        }
    };
    using Group = std::vector<std::size_t>;
    struct Try;
    struct Begun;
    std::vector<double> held_by_contacts();
    std::vector<Group> groups(const Drive& from, const Drive& to);
    // Where it was given up.
    std::optional<MoveEnd> advance(const Group& group, const Drive& from, const Drive& to,
                                   MoveOutcome& outcome);
    Begun begun(const MoveOutcome& outcome);
    void put_back(Begun& begun, const Drive& from, MoveOutcome& outcome);
    double step_to_try(const Group& group, const Drive& begin, const Drive& to) const;
    double stable_step(const Group& group) const;
    Try take(const Group& group, const Drive& begin, const Drive& now, double step,
             const std::vector<Stored>& store, MoveOutcome& outcome);
    bool holds(const Group& group, const Try& t, double budget);
    void keep(const Group& group, const Try& t, MoveOutcome& outcome);
    // Returns why there is no shorter one to be tried, if so.
    std::string take_back(const Group& group, Try& t, double budget, MoveOutcome& outcome);
    std::vector<char> all_but(const Group& group) const;
    void meet(const Group& group, double step, Meet how);
    std::vector<Stored> stored(const Group& group, const Drive& now);

    const Apparatus& apparatus_;
    std::vector<Mover> mover_;
    BodyContact contact_;
    std::vector<ContactSums> by_contact_;  // by body, as the bodies of the present group are
    std::vector<Tried>* tried_ = nullptr;
    long steps_ = 0;
};

}  // namespace swage
