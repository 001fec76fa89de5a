// SPDX-License-Identifier: GPL-3.0-or-later
// Which points lie close to each other, in about linear time. NOTE: geometry/near_pairs.h could
// tell, but keeps all pairs: where thousands of corners lie at one place, the square of that.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/box.h"

namespace swage {

// Calls act(a, b) once, in no order that tells anything, for each pair of finite points that are no
// further apart than `gap`.
template <typename Act>
void for_each_close_pair(const std::vector<Vec3>& point, double gap, const Act& act) {
    // Cells wider than the gap by more than their numbers' round-off: who is close is in the same
    // cell or a neighbouring one. Sorted, three cells in a row along z stand together.
    using Cell = std::array<std::int64_t, 3>;
    const Box box = box_of(point);
    if (box.empty()) return;
    double side = std::max(gap * (1 + 1e-6), 1e-9 * box.size().maxCoeff());
    if (side == 0) side = 1;
    std::vector<std::pair<Cell, int>> place;
    for (std::size_t p = 0; p < point.size(); ++p) {
        const Vec3 at = ((point[p] - box.low) / side).array().floor();
        place.push_back({Cell{static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()),
                              static_cast<std::int64_t>(at.z())},
                         static_cast<int>(p)});
    }
    std::sort(place.begin(), place.end());
    // Of the nine rows around a cell those that come after it, and its own from itself on.
    constexpr std::array<std::array<int, 2>, 5> kRows = {{{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}};
    std::array<std::size_t, 5> first{};
    for (std::size_t n = 0; n < place.size(); ++n) {
        const auto& [cell, a] = place[n];
        for (std::size_t row = 0; row < kRows.size(); ++row) {
            const Cell from{cell[0] + kRows[row][0], cell[1] + kRows[row][1], cell[2] - 1};
            // Where a row begins only grows from point to point.
            std::size_t& begin = first[row];
            while (begin < place.size() && place[begin].first < from) ++begin;
            const Cell last{from[0], from[1], cell[2] + 1};
            for (std::size_t m = row == 0 ? n + 1 : begin;
                 m < place.size() && place[m].first <= last; ++m) {
                const int b = place[m].second;
                if ((point[b] - point[a]).norm() <= gap) act(a, b);
            }
        }
    }
}

}  // namespace swage
