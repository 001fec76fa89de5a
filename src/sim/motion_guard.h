// SPDX-License-Identifier: GPL-3.0-or-later
// Watches bodies in motion. Steps are made in blocks; where anything goes wrong in one, all bodies
// go back to its start and try again with half the step:
//
//     a particle's place or speed is no number, or it goes more than half a spacing in a step;
//     an implicit step has not been solved;
//     a cell turns inside out (with an eighth of the step it still may: fast matter can crush
//         itself, and comes back by laws/volume_guard.h);
//     the energy that the bodies hold is more than was put in, by over a twentieth of all that ever
//         was, and grows by more than a five-hundredth of that in a block; by over a fifth, and
//         grows; or grows in one block by a two-hundredth (with a quarter of the step it still may:
//         what is squeezed to a tenth is a hundred times as stiff, and steps that were found for it
//         at rest are too long, but a shorter one does not mend everything).
#pragma once

#include <limits>
#include <string>

#include "sim/moving_body.h"

namespace swage {

inline constexpr double kMostGain = 0.05;     // of all energy that was ever put in
inline constexpr double kSuddenGain = 0.005;  // the same, in one block
inline constexpr int kSuddenHalvings = 2;     // after which as much may be gained
inline constexpr int kInsideOutHalvings = 3;  // after which a cell may turn inside out

enum class Fault { none, lost, unsolved, too_far, inside_out, gains };

struct Finding {
    Fault fault = Fault::none;
    std::size_t body = 0;
    long step = 0;    // of the stage
    double time = 0;  // [s], of the stage
    double way = 0;   // too_far: of the particle [m]
    double gain = 0;  // gains: share of all energy that was ever put in

    explicit operator bool() const { return fault != Fault::none; }
};

// The first thing wrong with a body after it has gone `way` at most in a step; its forces have
// been found. `allowed`: cells that may be inside out.
Finding look_at(const MovingBody& body, double way, int allowed);

// Says what is wrong at which particle, connection or cell of the bodies as they are, and what to
// change with this solver. `step`: the shortest that was tried [s].
std::string sentence_of(const Finding& finding, const MovingBody& body, const std::string& stage,
                        double step, Solver solver);

// The energy that all bodies hold against what was put in.
class EnergyGuard {
  public:
    using IsPlain = EnergyGuard;
    // A stage begins with this in the bodies [J].
    void start(double stored) { budget_ = stored > 0 ? stored : 0; }
    // In a block of steps `done` was put in, `turned_over` with every sign made positive, `lost`
    // went for good, and the bodies hold `gain` more [J]. Whether that can be, and is no more than
    // `at_once` of all that was ever put in; if so it counts, but for what may be `noise`.
    bool accepts(double turned_over, double done, double lost, double gain, double noise = 0,
                 double at_once = std::numeric_limits<double>::infinity());
    double excess_share() const { return budget_ > 0 ? tried_ / budget_ : 0; }

  private:
    double budget_ = 0;  // ever put in [J]
    double excess_ = 0;  // beyond that, no less than -kMostGain of it [J]
    double tried_ = 0;
};

}  // namespace swage
