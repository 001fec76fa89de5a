// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "matter/touch_points.h"

namespace swage {

// Where what of a body meets tools and other bodies is now [m].
inline std::vector<Vec3> touching_points(const Aggregate& matter) {
    const TouchPoints touch(matter);
    std::vector<Vec3> points;
    for (int p = 0; p < static_cast<int>(touch.size()); ++p) {
        if (!touch.meets(p)) continue;
        points.push_back(
            touch.points().position(static_cast<std::size_t>(p), matter.particle_position));
    }
    return points;
}

}  // namespace swage
