// SPDX-License-Identifier: GPL-3.0-or-later
// Batches of cells, one a lane: read from the rows of particles that a run of cells has at its
// corners, and their forces added to such rows. Everything is inlined into the kernel that asks.
//
// Lanes past the end of a run hold what stands in memory behind it, and what they get is dropped.
#pragma once

#include <cstring>

#include "laws/cell.h"

namespace swage {

template <typename V>
SWAGE_INLINE V load(const double* from) {
    V v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
template <typename V>
SWAGE_INLINE V load(const float* from) {
    return widened<V>(from);
}

// One vector field along the four particle rows of a run, by component: where its first cell's low
// ends are.
template <typename T>
struct CornerRows {
    T* at[3][4];
};

// Cells of a run from `begin` on; `count` of them are wanted, and the rows may be read up to `room`
// particles behind their beginning.
template <typename V>
SWAGE_INLINE CornerSums<V> gather(const CornerRows<const double>& rows, int begin, int count,
                                  int room) {
    constexpr int kWidth = kWidthOf<V>;
    CornerRows<const double> from;
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) from.at[i][q] = rows.at[i][q] + begin;
    }
    double copy[3][4][kWidth + 1];
    if (begin + kWidth + 1 > room) [[unlikely]] {
        for (int i = 0; i < 3; ++i) {
            for (int q = 0; q < 4; ++q) {
                for (int n = 0; n <= kWidth; ++n) {
                    copy[i][q][n] = from.at[i][q][n <= count ? n : count];
                }
                from.at[i][q] = copy[i][q];
            }
        }
    }
    CornerSums<V> c;
    V corner[8];
    const auto component = [&](int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            corner[2 * q] = load<V>(from.at[i][q]);
            corner[2 * q + 1] = load<V>(from.at[i][q] + 1);
        }
    };
    component(0);
    sum_corners(corner, c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    component(1);
    sum_corners(corner, c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    component(2);
    sum_corners(corner, c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
    return c;
}

// Forces of the two ends of a cell's edges along x meet on the particles between: they are added
// in registers, so that no particle is written twice in a row. What a batch leaves for the
// particle behind its last cell is carried to the next.
template <typename V>
struct ForceCarry {
    V high[3][4]{};
};

// `room`: particles behind the beginning of each row that may be written over with what they are.
template <typename V>
SWAGE_INLINE void add_forces(const CornerSums<V>& r, const CornerRows<double>& rows,
                             const int (&room)[4], int begin, int count, ForceCarry<V>& carry) {
    constexpr int kWidth = kWidthOf<V>;
    typename LaneBatch<kWidth>::Indices lane, shift;
    for (int l = 0; l < kWidth; ++l) lane[l] = l, shift[l] = l + kWidth - 1;
    const auto component = [&](const V(&force)[8], int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            const V low = force[2 * q], high = force[2 * q + 1];
            const V from_left = __builtin_shuffle(carry.high[i][q], high, shift);
            carry.high[i][q] = high;
            double* to = rows.at[i][q] + begin;
            V old;
            if (count >= kWidth) [[likely]] {
                std::memcpy(&old, to, sizeof old);
                old += low + from_left;
                std::memcpy(to, &old, sizeof old);
            } else {
                // Also the particle behind the run's last cell.
                const V sum = lane < count ? low + from_left : from_left;
                if (begin + kWidth <= room[q]) {
                    std::memcpy(&old, to, sizeof old);
                    old = lane <= count ? old + sum : old;
                    std::memcpy(to, &old, sizeof old);
                } else {
                    for (int l = 0; l <= count; ++l) to[l] += sum[l];
                }
            }
        }
    };
    V force[8];
    spread_corners(r.x.x, r.y.x, r.z.x, r.xy.x, r.yz.x, r.zx.x, r.xyz.x, force);
    component(force, 0);
    spread_corners(r.x.y, r.y.y, r.z.y, r.xy.y, r.yz.y, r.zx.y, r.xyz.y, force);
    component(force, 1);
    spread_corners(r.x.z, r.y.z, r.z.z, r.xy.z, r.yz.z, r.zx.z, r.xyz.z, force);
    component(force, 2);
}
// The particle behind the last cell of a run that ends with a whole batch.
template <typename V>
SWAGE_INLINE void add_carried(const CornerRows<double>& rows, int end, const ForceCarry<V>& carry) {
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) rows.at[i][q][end] += carry.high[i][q][kWidthOf<V> - 1];
    }
}

}  // namespace swage
