// SPDX-License-Identifier: GPL-3.0-or-later
// Free flight. Matter without strain, all of which moves alike, stays so while nothing but gravity
// acts on it, and steps of any length lead to where it goes,
//
//     x += v t + g t^2 / 2,   v += g t.
//
// So it may go at once for as long as it can touch nothing.
#pragma once

#include <optional>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/touch_points.h"

namespace swage {

inline constexpr double kWorthFlying = 512;  // steps that it takes otherwise; fewer are soon over

// Of matter that flies: in a step of this length [s], which its swings allow, neither forces nor
// speeds take any particle a billionth of a spacing aside from the others. [m/s]
std::optional<Vec3> flight_velocity(const Aggregate& matter, const Vec3Array& force, double step);

struct Flyer {
    const Vec3Array* position;  // of its particles [m]
    double spacing;             // [m]
    const TouchPoints* touch;   // null where there is no tool
    Vec3 velocity;              // [m/s]
};

// How long such bodies fly before any can touch a tool or another, a little less; no longer than
// the leg that they are in has left where a tool moves in it [s]. `now`: of that leg, from one
// drive to another.
double free_time(const std::vector<Flyer>& bodies, const Apparatus& apparatus, const Drive& from,
                 const Drive& to, const Drive& now, const Vec3& gravity);

}  // namespace swage
