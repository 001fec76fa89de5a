// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/parted.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swage {

bool is_torn(const Aggregate& matter, std::size_t point) {
    constexpr double kCarries = 1e-6;
    if (!is_parted(matter, point)) return false;
    const SurfacePoints::Carriers by = matter.surface.carriers(point);
    std::array<unsigned, 8> group;
    for (unsigned c = 0; c < 8; ++c) group[c] = 1u << c;
    unsigned carry = 0;
    for (unsigned c = 0; c < 8; ++c) carry |= unsigned(std::abs(by.weight[c]) > kCarries) << c;
    for (const CellConnection& link : kCellConnection) {
        const ParticleId lower = by.corner[std::size_t(link.corner)];
        if (!(matter.connection[std::size_t(link.direction)].weight[lower] > 0)) continue;
        const unsigned joined =
            group[std::size_t(link.corner)] | group[std::size_t(upper_corner(link))];
        for (unsigned c = 0; c < 8; ++c) {
            if (joined >> c & 1) group[c] = joined;
        }
    }
    return std::any_of(group.begin(), group.end(), [&](unsigned together) {
        return (together & carry) != 0 && (together & carry) != carry;
    });
}

}  // namespace swage
