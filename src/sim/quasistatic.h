// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium by relaxation. Each move of the drive is solved from the state before it: positions
// are the only unknowns; plastic strain and friction anchors are returned from their committed
// values on every evaluation and committed once, after the move has converged, so that the
// overshoots of the relaxation leave no trace.
//
// Relaxation: downhill with momentum (sim/relaxation_schedule.h), with a mass for each particle
// under which a step of one is stable everywhere, and by the stiffness for the slow motions of the
// body as a whole (sim/coarse_space.h).
//
// NOTE: relaxation follows *some* path to a stable state; kinetic energy set free by a snap is
// lost, and an unstable equilibrium that nothing disturbs is not left.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/coarse_space.h"
#include "sim/drive_motion.h"
#include "sim/free_pieces.h"
#include "sim/lattice_forces.h"
#include "sim/load_set.h"
#include "sim/move_outcome.h"
#include "sim/newton.h"
#include "sim/push_measure.h"
#include "sim/resting_contacts.h"
#include "sim/self_contact.h"
#include "sim/settings.h"

namespace swage {

class QuasistaticSolver {
  public:
    QuasistaticSolver(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings);

    // Throws Error(stopped) when an increment fails at the deepest halving; the matter is then as
    // it was before that increment.
    MoveOutcome advance(const Drive& from, const Drive& to);

    // A blade has severed connections.
    void connections_changed(std::size_t body = 0);
    double elastic_energy(std::size_t = 0) { return lattice_.elastic_energy(matter_); }  // [J]
    const LoadSet& pushes(std::size_t = 0) const { return pushes_; }

  private:
    struct Relaxation {
        bool converged = false;
        int iterations = 0;
        double residual = 0;
        bool falls = false;  // it, or a piece of it
    };
    enum class Unsolved { stop, leave };
    // Whether there is an equilibrium at `to`; without one the matter stays as it was, or it stops.
    bool increment(const Drive& from, const Drive& to, int depth, MoveOutcome& outcome,
                   Unsolved unsolved = Unsolved::stop);
    double share_to_yield(const Drive& from, const Drive& to, double held);
    std::string met(const Drive& to);
    bool take_back(Relaxation& tried, const Drive& to, int depth, MoveOutcome& outcome);
    [[noreturn]] void stop(const Relaxation& tried, const Drive& to, int depth,
                           const std::string& met) const;
    Relaxation relax(const Drive& to);
    Relaxation settle(const Drive& to);
    Relaxation relax_stably(const Drive& to, MoveOutcome& outcome);
    Relaxation solve_smooth(const Drive& to);
    NewtonProblem problem_of(const Drive& to, RestingContacts::Slipping slipping);
    double residual_of(const Vec3Array& force, const Drive& to) const;
    void connections_renewed();
    void find_bounds();
    void find_masses();
    // `moved`: as RestingContacts::add_forces() takes it.
    void evaluate(const Drive& to, double moved = std::numeric_limits<double>::infinity());
    bool touches() { return !contacts_.pairs().empty() || self_.presses(); }
    double push_measure(const Drive& to) const;
    void let_crack(const Drive& to, MoveOutcome& outcome);
    double booked(const Drive& now, const BodyOutcome& outcome);
    bool begin(const Drive& from, BodyOutcome& outcome);
    void let_go(const Drive& from, MoveOutcome& outcome);
    double seat_pieces(const Drive& from, const Drive& to);
    void stay(const Drive& to);
    bool begins_to_fall(const Drive& to);
    int let_hang(const Drive& to);
    bool commit(MoveOutcome& outcome);

    Aggregate& matter_;
    const Apparatus& apparatus_;
    SimSettings settings_;
    LatticeForces lattice_;
    std::unique_ptr<Newton> newton_;  // null: the matter is not smooth
    // Where it has not converged it is not tried for a while, twice as long each time in a row:
    // moves to go, and the last such pause.
    int newton_rests_ = 0, newton_pause_ = 0;
    std::optional<CoarseSpace> coarse_;  // from the first relaxation on
    RestingContacts contacts_;
    LoadSet pushes_;
    SelfContact self_;
    double body_size_;  // [m]
    bool yields_ = false;
    std::vector<double> lattice_bound_;
    std::vector<double> mass_, inverse_mass_, drag_;
    double accuracy_ = 0;  // of the residual: the tolerance, or less
    int mirrored_ = 0;     // cells inside out
    Vec3Array force_, velocity_;
    double hold_ = 1;         // share of the drag that acts
    double enough_hold_ = 1;  // and that held nothing back in the last relaxation
    Vec3Array held_, rest_;   // positions that the drag pulls back to: now, at first
    FreePieces free_;
    // Positions: when the stage began, before the move, when the candidates were found.
    Vec3Array begun_at_, start_, listed_;
    Foresight foresight_;
    SlipWatch slips_;
    int splits_ = 0;     // of the present move, for yield
    bool seats_ = true;  // until a piece finds no seat, in this advance
    bool begun_ = false;
    bool severed_ = false;  // by a blade, since the last equilibrium
    PushMeasure measure_;
    std::vector<LoadSum> load_;  // at the end of the last increment, by tool, then grip
};

}  // namespace swage
