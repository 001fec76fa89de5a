// SPDX-License-Identifier: GPL-3.0-or-later
// What the cells of a batch have flowed, as lanes, and what is in a batch.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "laws/cell_back.h"
#include "matter/aggregate.h"
#include "sim/cell_batch.h"

namespace swage {

static_assert(sizeof(CellHistory<double>) == kCellHistory * sizeof(double));
static_assert(sizeof(BackStrain<double>) == kCellBack * sizeof(double));

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
    const float* back[kCellBack] = {};    // null: and none has a back stress
    int cells = 0;

    explicit HistoryRows(const Aggregate& matter)
        : cells(static_cast<int>(matter.cell_fill.size())) {
        if (matter.cell_history.empty()) return;
        for (int n = 0; n < kCellHistory; ++n) row[n] = matter.cell_history.row[n].data();
        if (matter.cell_back.empty()) return;
        for (int n = 0; n < kCellBack; ++n) back[n] = matter.cell_back.row[n].data();
    }
    const float* hardening() const { return row[kCellHistory - 1]; }
};

// Where so many rows have the numbers of a batch, whose lanes past the last cell are zero.
template <typename V, int kCount>
struct BatchRows {
    float copy[kCount][kLanes];
    const float* from[kCount];

    SWAGE_INLINE BatchRows(const float* const (&row)[kCount], int cells, CellId cell) {
        for (int n = 0; n < kCount; ++n) from[n] = row[n] + cell;
        if (cell + kWidthOf < V >> cells) [[unlikely]] {
            for (int n = 0; n < kCount; ++n) {
                for (int l = 0; l < kWidthOf<V>; ++l) {
                    copy[n][l] = cell + l < cells ? from[n][l] : 0.0f;
                }
                from[n] = copy[n];
            }
        }
    }
};

template <typename V>
SWAGE_INLINE CellHistory<V> load_history(const HistoryRows& rows, CellId cell) {
    const BatchRows<V, kCellHistory> batch(rows.row, rows.cells, cell);
    CellHistory<V> history;
    for_each_number(
        history, [&](int n, V& number)
                     __attribute__((always_inline)) { number = load<V>(batch.from[n]); });
    return history;
}
// Zero while none has a back stress.
template <typename V>
SWAGE_INLINE BackStrain<V> load_back(const HistoryRows& rows, CellId cell) {
    BackStrain<V> back{};
    if (rows.back[0] == nullptr) return back;
    const BatchRows<V, kCellBack> batch(rows.back, rows.cells, cell);
    for_each_number(
        back.strain, back.modes, [&](int n, V& number) __attribute__((always_inline)) {
            number = load<V>(batch.from[n]);
        });
    return back;
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
