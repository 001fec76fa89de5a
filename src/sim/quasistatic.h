// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium by relaxation. Each move of the drive is solved from the state before it: positions
// are the only unknowns; plastic strain and friction anchors are returned from their committed
// values on every evaluation and committed once, after the move has converged, so that the
// overshoots of the relaxation leave no trace.
//
// NOTE: relaxation follows *some* path to a stable state; kinetic energy set free by a snap is
// lost, and an unstable equilibrium that nothing disturbs is not left.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/drive_motion.h"
#include "sim/equilibrium_search.h"
#include "sim/move_outcome.h"
#include "sim/settings.h"
#include "sim/static_forces.h"
#include "sim/static_move.h"

namespace swage {

class QuasistaticSolver {
  public:
    QuasistaticSolver(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings);

    // Is given up when an increment fails at the deepest halving; the matter is then as it was
    // before that increment.
    MoveOutcome advance(const Drive& from, const Drive& to, const DriveAt& way = {});

    void masses_changed(std::size_t, const std::vector<double>& was) {  // as LoadSet's
        forces_.pushes.masses_changed(matter_, was);
    }
    // A blade has severed connections. Returns what contacts and grips held by what is gone [J].
    double connections_changed(std::size_t body, const Drive& now);
    double elastic_energy(std::size_t = 0) { return forces_.elastic_energy(); }  // [J]
    const LoadSet& pushes(std::size_t = 0) const { return forces_.pushes; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(forces_, foresight_, slips_, load_, splits_, seats_, begun_, severed_, stands_, beyond_,
           has_stopped_);
        search_.visit(io, forces_);
    }

  private:
    void go(const Drive& from, const Drive& to, MoveOutcome& outcome);
    enum class Unsolved { stop, leave };
    // Whether there is an equilibrium at `to` within the limits; without one the matter stays as it
    // was, or it stops; beyond a limit it stays where it has got to.
    bool increment(const Drive& from, const Drive& to, int depth, MoveOutcome& outcome,
                   Unsolved unsolved = Unsolved::stop);
    StaticMove begin_move(const Drive& from, const Drive& to, int depth,
                          const BodyOutcome& outcome);
    double put_back(const StaticMove& move);
    bool take_back(Relaxation& tried, const StaticMove& move, MoveOutcome& outcome);
    double share_to_yield(const StaticMove& move);
    void keep(const StaticMove& move, bool buckled, MoveOutcome& outcome);
    bool commit(BodyOutcome& outcome);
    void connections_renewed();

    std::string met(const StaticMove& move);
    [[noreturn]] void stop(const Relaxation& tried, const StaticMove& move, const std::string& met);
    std::string acts_at_once(const StaticMove& move);

    bool begin(const Drive& from, BodyOutcome& outcome);
    void let_go(const Drive& from, MoveOutcome& outcome);
    void let_crack(const Drive& to, MoveOutcome& outcome);
    double booked(const Drive& now, const BodyOutcome& outcome);

    // How near the parts are to their limits: the nearest, and what it bears over its limit.
    struct Reach {
        using IsPlain = Reach;
        std::size_t limit = 0;
        double share = 0;
    };
    bool is_limited() const { return !apparatus_.limit.empty() && !has_stopped_; }
    double borne_of(std::size_t limit, const std::vector<PartSum>& load, const Drive& now) const;
    Reach reach_of(const std::vector<PartSum>& load, const Drive& now) const;
    bool goes_beyond(const StaticMove& move);
    void approach(MoveOutcome& outcome);
    void come_to_stop(MoveOutcome& outcome);
    Drive between(const Drive& from, const Drive& to, double s) const;

    double seat_pieces(StaticMove& move);
    void stay(const StaticMove& move);

    Aggregate& matter_;
    const Apparatus& apparatus_;
    SimSettings settings_;
    StaticForces forces_;
    EquilibriumSearch search_;
    Foresight foresight_;
    SlipWatch slips_;
    std::vector<PartSum> load_;  // at the end of the last increment, by tool, then grip
    int splits_ = 0;             // of the present move, for yield
    bool seats_ = true;          // until a piece finds no seat, in this advance
    bool begun_ = false;
    bool severed_ = false;  // by a blade, since the last equilibrium

    Drive stands_;  // where the matter was last at rest
    // Where there are limits: the drives between those of a move, and the last try that went
    // beyond.
    const DriveAt* way_ = nullptr;
    struct Beyond {
        Drive at;
        Reach reach;

        template <typename Io>
        void visit(Io& io) {
            io(at, reach);
        }
    };
    Beyond beyond_;
    bool has_stopped_ = false;
};

}  // namespace swage
