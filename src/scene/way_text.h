// SPDX-License-Identifier: GPL-3.0-or-later
// Which way of the world something goes, in words.
#pragma once

#include <fmt/format.h>

#include <string>

#include "machines/world_axis.h"

namespace swage {

// "-z" along an axis, else "[0.6, 0.8, 0]". `way`: unit.
inline std::string way_text(const Vec3& way) {
    for (int n = 1; n <= 6; ++n) {
        const auto axis = static_cast<WorldAxis>(n);
        if (direction_of(axis).dot(way) > 1 - 1e-6) return name_of(axis);
    }
    return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", way.x(), way.y(), way.z());
}

}  // namespace swage
