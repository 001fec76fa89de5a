// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/parted.h"

#include <algorithm>
#include <cmath>

#include "matter/cell_parts.h"

namespace swage {

bool is_torn(const Aggregate& matter, std::size_t point) {
    constexpr double kCarries = 1e-6;
    if (!is_parted(matter, point)) return false;
    const SurfacePoints::Carriers by = matter.surface.carriers(point);
    CornerMask carry = 0;
    for (int c = 0; c < 8; ++c) carry |= (std::abs(by.weight[c]) > kCarries) << c;
    const CornerGroups groups = corner_groups(matter, by.corner);
    return std::any_of(groups.begin(), groups.end(), [&](CornerMask together) {
        return (together & carry) != 0 && (together & carry) != carry;
    });
}

}  // namespace swage
