// SPDX-License-Identifier: GPL-3.0-or-later
// What the cells of a batch have flowed, as lanes, and what is in a batch.
#pragma once

#include <algorithm>
#include <cstdint>

#include "matter/aggregate.h"
#include "sim/cell_batch.h"

namespace swage {

static_assert(sizeof(CellHistory<double>) == kCellHistory * sizeof(double));

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
    const float* row[kCellHistory] = {};  // null: nothing has flowed
    int cells = 0;

    explicit HistoryRows(const Aggregate& matter)
        : cells(static_cast<int>(matter.cell_fill.size())) {
        if (matter.cell_history.empty()) return;
        for (int n = 0; n < kCellHistory; ++n) row[n] = matter.cell_history.row[n].data();
    }
    const float* hardening() const { return row[kCellHistory - 1]; }
};

template <typename V>
SWAGE_INLINE CellHistory<V> load_history(const HistoryRows& rows, CellId cell) {
    float copy[kCellHistory][kLanes];
    const float* from[kCellHistory];
    for (int n = 0; n < kCellHistory; ++n) from[n] = rows.row[n] + cell;
    if (cell + kWidthOf < V >> rows.cells) [[unlikely]] {
        for (int n = 0; n < kCellHistory; ++n) {
            for (int l = 0; l < kWidthOf<V>; ++l) {
                copy[n][l] = cell + l < rows.cells ? from[n][l] : 0.0f;
            }
            from[n] = copy[n];
        }
    }
    return history_from<V>([&](int n) __attribute__((always_inline)) { return load<V>(from[n]); });
}

// Whether any cell of a batch of eight has flowed.
SWAGE_INLINE bool has_flowed(const HistoryRows& rows, CellId cell) {
    if (rows.hardening() == nullptr) return false;
    std::int64_t bits[kLanes / 2] = {};
    const std::size_t count = std::min(kLanes, rows.cells - cell);
    std::memcpy(bits, rows.hardening() + cell,
                count == kLanes ? sizeof bits : count * sizeof(float));
    return ((bits[0] | bits[1]) | (bits[2] | bits[3])) != 0;
}

}  // namespace swage
