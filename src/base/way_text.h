// SPDX-License-Identifier: GPL-3.0-or-later
// Which way of the world something goes, in words.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "base/math.h"

namespace swage {

// "-z" along an axis, else "[0.6, 0.8, 0]", to a thousandth. `way`: unit.
inline std::string way_text(const Vec3& way) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(way[axis]) <= 1 - 1e-6) continue;
        return fmt::format("{}{}", way[axis] < 0 ? "-" : "", "xyz"[axis]);
    }
    const Vec3 told = (1e3 * way).array().round() / 1e3 + 0.0;  // without a sign of 0
    return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", told.x(), told.y(), told.z());
}

}  // namespace swage
