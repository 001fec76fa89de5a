// SPDX-License-Identifier: GPL-3.0-or-later
// What moving the matter on took.
#pragma once

#include <algorithm>

namespace swage {

// Of one move, a frame or a stage.
struct StepCounts {
    using IsPlain = StepCounts;

    long iterations = 0, increments = 0, halvings = 0;
    long steps = 0, rejected = 0;  // in motion: kept, and taken back
    long rescued = 0;              // of those kept: implicit ones where explicit ones went wrong
    double shortest_step = 0;      // likewise [s]
    double residual = 0;           // the largest, over the largest push; quasi-static only

    // Those of what comes next.
    void count(const StepCounts& next) {
        iterations += next.iterations;
        increments += next.increments;
        halvings += next.halvings;
        if (next.steps > 0) {
            shortest_step =
                steps > 0 ? std::min(shortest_step, next.shortest_step) : next.shortest_step;
        }
        steps += next.steps;
        rejected += next.rejected;
        rescued += next.rescued;
        residual = std::max(residual, next.residual);
    }
};

}  // namespace swage
