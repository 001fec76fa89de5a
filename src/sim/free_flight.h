// SPDX-License-Identifier: GPL-3.0-or-later
// Free flight. Matter without strain, all of which moves alike, stays so while nothing but gravity
// acts on it, and steps of any length lead to where it goes,
//
//     x += v t + g t^2 / 2,   v += g t.
//
// So it may go at once for as long as it can touch nothing. What presses on anything, or sticks to
// it, does not fly, though nothing has moved yet: whoever asks sees to that (MovingBodies).
#pragma once

#include <optional>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/touch_points.h"
#include "sim/settings.h"

namespace swage {

inline constexpr double kWorthFlying = 512;  // steps that it takes otherwise; fewer are soon over

// Whether a medium drags at what moves.
inline bool medium_drags(const SimSettings& settings) {
    return settings.medium_density * settings.drag_coefficient > 0 || settings.directional_drag > 0;
}

// Whether, while nothing is touched, gravity alone acts in explicit steps. Whether that changes is
// for the drives to say.
bool only_gravity_acts(const Apparatus& apparatus, const SimSettings& settings);

// What rounding its places leaves of energy in matter that takes steps of this length [s]: twice as
// much as it does to places, were the steps the longest that are stable [J].
double rounding_energy(const Aggregate& matter, double step);
// The same by which elastic energy alone may be wrong: that of rubber and foam is a difference of
// terms of the size of their modulus [J].
double elastic_rounding(const Aggregate& matter);

// Matter flies where neither its elastic energy [J] nor what its particles have beside their mean
// velocity is more than rounding leaves; what is more may be a slow swing or spin, which steps
// would follow.
bool holds_strain(const Aggregate& matter, double elastic, double step);
std::optional<Vec3> flight_velocity(const Aggregate& matter, double step);  // [m/s]

struct Flyer {
    const Vec3Array* position;  // of its particles [m]
    double spacing;             // [m]
    const TouchPoints* touch;   // null where there is no tool
    Vec3 velocity;              // [m/s]
};

// How long such bodies, which touch nothing, fly before any can touch a tool or another, a little
// less; no longer than the leg that they are in has left where a tool moves in it [s]. `now`: of
// that leg, from one drive to another.
double free_time(const std::vector<Flyer>& bodies, const Apparatus& apparatus, const Drive& from,
                 const Drive& to, const Drive& now, const Vec3& gravity);

}  // namespace swage
