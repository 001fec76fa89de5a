// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the equilibrium that a move ends in: by Newton's method where the body is smooth and
// nothing touches it, else by relaxation (sim/settling.h), with a drag that is let go until it
// holds nothing back; and on from there where the body buckles.
#pragma once

#include <memory>
#include <optional>

#include "sim/coarse_space.h"
#include "sim/newton.h"
#include "sim/static_forces.h"
#include "sim/static_move.h"

namespace swage {

class EquilibriumSearch {
  public:
    // The stage begins with these.
    EquilibriumSearch(const StaticForces& forces, const SimSettings& settings);

    void connections_changed(const StaticForces& forces);

    // Moves the particles on from where they are. NOTE: what it leaves when it does not converge
    // means nothing, but to a search for why.
    Relaxation find(StaticForces& forces, StaticMove& move);

    template <typename Io>
    void visit(Io& io, const StaticForces& forces) {  // what steps change, where these are known
        io(newton_rests_, newton_pause_, enough_hold_, begun_at_, has_buckled_, led_by_);
        bool has_coarse = coarse_.has_value();
        io(has_coarse);
        if constexpr (Io::kReads) {
            connections_changed(forces);
            if (has_coarse) coarse_.emplace(forces.matter);
        }
        if (coarse_) io(*coarse_);
        if (newton_) io(*newton_);
    }

  private:
    Relaxation relax(StaticForces& forces, const StaticMove& move, double accuracy);
    bool lead_aside(Aggregate& matter, StaticMove& move);
    bool goes_far_aside(const Aggregate& matter, const StaticMove& move);
    Relaxation solve_smooth(StaticForces& forces, const StaticMove& move, double accuracy);

    double tolerance_;
    int iteration_limit_;
    std::unique_ptr<Newton> newton_;  // null: the matter is not smooth
    // Where it has not converged it is not tried for a while, twice as long each time in a row:
    // moves to go, and the last such pause.
    int newton_rests_ = 0, newton_pause_ = 0;
    std::optional<CoarseSpace> coarse_;  // from the first relaxation on
    double enough_hold_ = 1;    // share of the drag that held nothing back in the last relaxation
    Vec3Array begun_at_;        // positions, when the stage began
    bool has_buckled_ = false;  // since then
    Vec3Array led_by_;          // aside, in all, until it comes back; empty: not
};

}  // namespace swage
