// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies in motion by explicit steps with real masses: symplectic Euler,
//
//     v += dt f(x, v) / m,   x += dt v,
//
// all bodies by the same step, which is stable for the fastest of them (explicit_step()). Contact
// and grip points are kept below a quarter of what their carriers can follow in one step.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/move_outcome.h"
#include "sim/moving_body.h"
#include "sim/settings.h"

namespace swage {

class ExplicitSolver {
  public:
    ExplicitSolver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                   const SimSettings& settings);

    // Throws Error(stopped) when the state is not finite even after halving the step; the matter is
    // then as it was before the move.
    MoveOutcome advance(const Drive& from, const Drive& to);
    void connections_changed(std::size_t body);
    double elastic_energy(std::size_t body) { return body_[body].elastic_energy(); }  // [J]
    const LoadSet& pushes(std::size_t body) const { return body_[body].pushes(); }

  private:
    bool steps(const Drive& from, const Drive& to, double dt, MoveOutcome& outcome);

    const Apparatus& apparatus_;
    SimSettings settings_;
    std::vector<MovingBody> body_;
    double spacing_;  // the least [m]
    double step_;     // [s]
};

}  // namespace swage
