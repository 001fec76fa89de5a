// SPDX-License-Identifier: GPL-3.0-or-later
// A way along one of the world's axes, by which scene and machine files say how a work frame lies.
#pragma once

#include "base/math.h"

namespace swage {

// automatic: the file leaves it open.
enum class WorldAxis { automatic, x, minus_x, y, minus_y, z, minus_z };

inline const char* name_of(WorldAxis axis) {
    constexpr const char* kName[] = {"auto", "x", "-x", "y", "-y", "z", "-z"};
    return kName[static_cast<int>(axis)];
}

// Not of automatic.
inline Vec3 direction_of(WorldAxis axis) {
    const int n = static_cast<int>(axis) - 1;
    return (n % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(n / 2);
}

// Whether both are settled, and on one line.
inline bool lie_along(WorldAxis a, WorldAxis b) {
    return a != WorldAxis::automatic && b != WorldAxis::automatic &&
           (static_cast<int>(a) - 1) / 2 == (static_cast<int>(b) - 1) / 2;
}

}  // namespace swage
