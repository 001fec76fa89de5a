// SPDX-License-Identifier: GPL-3.0-or-later
// A stiff body that loads push onto its rests rocks, slides and rolls there, far beside what it
// gives way by. Relaxation takes very long over that, for it moves everything a little at a time,
// and what drives such a motion may be small. A rigid body has six numbers.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"
#include "sim/held_point.h"

namespace swage {

struct SeatProblem {
    // What pushes the matter from outside, at the present positions.
    std::function<void(Vec3Array& force)> add_loads;
    // What it touches there, and how the forces of that grow with a motion.
    std::function<void(Vec3Array& force)> add_contacts;
    std::function<std::vector<HeldPoint>()> held;
    // Particles have moved, by half a spacing at most, since the last call.
    std::function<void()> look_around;
    double drag;    // of a particle that is free to go, least [N/m]
    double heavy;   // how much stronger the loads may be at first, at least 1: the way to a rest is
                    // long beside what they press into it
    double enough;  // of a sum of forces, or of torques over the body's radius, may be left [N]
    double reach;   // that it may go [m]
};

// Moves these particles as one rigid body, downhill, to where what pushes them is in balance.
// Where no such place is found they are put back, and this says false.
bool seat(Aggregate& matter, const std::vector<ParticleId>& piece, const SeatProblem& problem);

}  // namespace swage
