// SPDX-License-Identifier: GPL-3.0-or-later
// A stage's way in legs, each so short that drive_between() follows the machine's own motions along
// it. How often a run is looked at, its frames, does not decide where its tools go: a grip that
// turns by 240 degrees between two frames would turn back by 120, and a load that swings between
// them would be none.
#pragma once

#include <vector>

#include "machines/machine.h"

namespace swage {

struct Leg {
    using IsPlain = Leg;

    int frame;          // 0 for the first
    double begin, end;  // of the stage, 0 to 1
    bool bends =
        false;  // in motion, where a cubic follows the machine; else straight, as jumps are
};

struct Legs {
    std::vector<Leg> leg;  // of each frame one or more
    int lost = 0;          // frames in which something changes too fast even for the shortest legs
};

// On no leg a turn of more than a quarter, nor anything beside its straight way by more than
// `slack` at the work-piece [m], nor a load, at any of 256 times a frame (fewer, but at least 4,
// where that were over a million in all), by more than a hundredth of its full strength. What jumps
// does so within the shortest leg, a 64th of a frame. In motion, where what a load does goes by how
// long it does it, a load may be off by a thousandth, and one that jumps does so within a 4096th;
// and tools and grips go along a leg without corners, by a cubic that is off by no more than a
// 400th of what the straight way is, so that what they carry feels their accelerations.
// `begin`: of the stage, where there is nothing before it.
Legs legs_of(const Machine& machine, int frames, double slack, bool in_motion, double begin = 0);

// Of a frame as long as nothing jumps.
inline constexpr int kMostLegs = 64;

// At the start and at the end of each of `steps` parts of each leg, of a stage of `duration` [s].
// The last of a leg that bends says how.
std::vector<Drive> drives_of(const Machine& machine, const std::vector<Leg>& legs, int steps,
                             double duration);

// What legs and drives take, about, at one leg a frame [byte].
double bytes_of_way(const MachineSpec& spec, int frames, bool in_motion);

}  // namespace swage
