// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/cell_parts.h"

#include <algorithm>

namespace swage {

namespace {

template <class Joined>
CornerGroups grouped(Joined&& is_joined) {
    CornerGroups group;
    for (int c = 0; c < 8; ++c) group[c] = static_cast<CornerMask>(1 << c);
    for (const CellConnection& link : kCellConnection) {
        if (!is_joined(link)) continue;
        const CornerMask joined = group[link.corner] | group[upper_corner(link)];
        for (int c = 0; c < 8; ++c) {
            if (joined >> c & 1) group[c] = joined;
        }
    }
    return group;
}

}  // namespace

CornerGroups corner_groups(const Aggregate& matter, const std::array<ParticleId, 8>& corner) {
    return grouped([&](const CellConnection& link) {
        return matter.connection[link.direction].weight[corner[link.corner]] > 0;
    });
}

CornerGroups corner_groups_of_cut(const Aggregate& matter,
                                  const std::array<ParticleId, 8>& corner) {
    return grouped([&](const CellConnection& link) {
        const ConnectionArrays& all = matter.connection[link.direction];
        const ParticleId lower = corner[link.corner];
        return all.weight[lower] > 0 || (!all.damage.empty() && all.damage[lower] >= 1);
    });
}

bool corners_hang_together(const Aggregate& matter, const std::array<ParticleId, 8>& corner) {
    float least = 1;
    for (const auto& [direction, low] : kCellConnection) {
        least = std::min(least, matter.connection[direction].weight[corner[low]]);
    }
    if (least > 0) return true;
    return corner_groups(matter, corner)[0] == kAllCorners;
}

int heaviest_corner(const std::array<double, 8>& weight, CornerMask corners) {
    int heaviest = -1;
    for (int c = 0; c < 8; ++c) {
        if (corners >> c & 1 && (heaviest < 0 || weight[c] > weight[heaviest])) heaviest = c;
    }
    return heaviest;
}

}  // namespace swage
