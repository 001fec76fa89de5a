// SPDX-License-Identifier: GPL-3.0-or-later
// What the cells of a batch have flowed, as lanes, and what is in a batch.
#pragma once

#include <algorithm>
#include <cstdint>

#include "matter/aggregate.h"
#include "sim/cell_batch.h"

namespace swage {

inline constexpr int kCellStrains = 6, kCellModes = 12;

// By batches of eight cells of a run: all full and whole, or where their fills and centroids begin.
inline constexpr std::int32_t kWholeCells = -1;
inline constexpr int kCellShares = 4;  // fill and centroid, eight of each
inline int batches_of(const CellRun& run) { return (run.count + kLanes - 1) / kLanes; }

// Whether the batch of a run that begins with this cell of it is of full cells, seen from their
// middles.
inline bool is_whole_batch(const Aggregate& matter, const std::vector<float>& fill,
                           const CellRun& run, int begin) {
    for (int n = begin; n < std::min(run.count, begin + kLanes); ++n) {
        const CellId cell = run.first + n;
        if (fill[cell] != 1 || !matter.cell_centroid[cell].isZero(0)) return false;
    }
    return true;
}

// The committed history of all cells.
struct HistoryRows {
    const float *strain[kCellStrains] = {}, *modes[kCellModes] = {};
    const float* alpha = nullptr;  // null: nothing has flowed
    int cells = 0;

    explicit HistoryRows(const Aggregate& matter)
        : cells(static_cast<int>(matter.cell_fill.size())) {
        if (matter.cell_hardening.empty()) return;
        for (int n = 0; n < kCellStrains; ++n) strain[n] = matter.cell_plastic_stretch[n].data();
        for (int n = 0; n < kCellModes; ++n) modes[n] = matter.cell_plastic_modes[n].data();
        alpha = matter.cell_hardening.data();
    }
};

template <typename V>
SWAGE_INLINE CellHistory<V> load_history(const HistoryRows& rows, CellId cell) {
    constexpr int kAll = kCellStrains + kCellModes + 1;
    float copy[kAll][kLanes];
    const float* from[kAll];
    for (int n = 0; n < kCellStrains; ++n) from[n] = rows.strain[n] + cell;
    for (int n = 0; n < kCellModes; ++n) from[kCellStrains + n] = rows.modes[n] + cell;
    from[kAll - 1] = rows.alpha + cell;
    if (cell + kWidthOf < V >> rows.cells) [[unlikely]] {
        for (int n = 0; n < kAll; ++n) {
            for (int l = 0; l < kWidthOf<V>; ++l) {
                copy[n][l] = cell + l < rows.cells ? from[n][l] : 0.0f;
            }
            from[n] = copy[n];
        }
    }
    const auto triple = [&](int m) __attribute__((always_inline)) {
        return Triple<V>{load<V>(from[m]), load<V>(from[m + 1]), load<V>(from[m + 2])};
    };
    return {{load<V>(from[0]), load<V>(from[1]), load<V>(from[2]), load<V>(from[3]),
             load<V>(from[4]), load<V>(from[5])},
            {triple(6), triple(9), triple(12), triple(15)},
            load<V>(from[18])};
}

// Whether any cell of a batch of eight has flowed.
SWAGE_INLINE bool has_flowed(const HistoryRows& rows, CellId cell) {
    if (rows.alpha == nullptr) return false;
    std::int64_t bits[kLanes / 2] = {};
    const std::size_t count = std::min(kLanes, rows.cells - cell);
    std::memcpy(bits, rows.alpha + cell, count == kLanes ? sizeof bits : count * sizeof(float));
    return ((bits[0] | bits[1]) | (bits[2] | bits[3])) != 0;
}

}  // namespace swage
