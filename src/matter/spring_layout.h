// SPDX-License-Identifier: GPL-3.0-or-later
// How a cell's connections lie in it, for the law by which they flow.
#pragma once

#include "laws/spring_frame.h"
#include "matter/lattice.h"

namespace swage {

inline constexpr SpringLayout kSpringLayout = [] {
    constexpr double kRootHalf = 0.70710678118654752;
    SpringLayout layout{};
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& c = kCellConnection[slot];
        const bool edge = c.direction < kEdgeCount;
        layout.share[slot] = edge ? kEdgeShare : kDiagonalShare;
        for (int way = 0; way < kBendings; ++way) {
            const auto moved = [&](int corner) {
                const int x = corner & 1 ? 1 : -1, y = corner & 2 ? 1 : -1, z = corner & 4 ? 1 : -1;
                return way == 0 ? x * y : way == 1 ? y * z : way == 2 ? z * x : x * y * z;
            };
            layout.bent[slot][way] =
                (edge ? 1 : kRootHalf) * 0.5 * (moved(upper_corner(c)) - moved(c.corner));
        }
    }
    return layout;
}();

}  // namespace swage
