// SPDX-License-Identifier: GPL-3.0-or-later
// Batches of cells, one a lane: read from the rows of particles that a run of cells has at its
// corners, and their forces added to such rows. Everything is inlined into the kernel that asks.
//
// Lanes past the end of a run hold what stands in memory behind it, and what they get is dropped.
#pragma once

#include "laws/cell.h"
#include "sim/force_slabs.h"
#include "sim/lane_memory.h"

namespace swage {

// A vector field along the four particle rows of a run, by component: where the low ends of a cell
// are. They may be read up to `room` particles from there on.
struct CornerRows {
    const double* at[3][4];
    int room;
};
// From so many cells behind the run's first on.
SWAGE_INLINE CornerRows corner_rows(const Vec3Array& field, const CellRun& run, int behind = 0) {
    CornerRows rows;
    for (int q = 0; q < 4; ++q) {
        const ParticleId low = run.row[q] + behind;
        rows.at[0][q] = field.x.data() + low;
        rows.at[1][q] = field.y.data() + low;
        rows.at[2][q] = field.z.data() + low;
    }
    rows.room = static_cast<int>(field.size()) - run.row[3] - behind;  // the last of the rows
    return rows;
}

// Cells of a run from `begin` on, of which `count` are wanted.
template <typename V>
SWAGE_INLINE CornerSums<V> gather(const CornerRows& rows, int begin, int count) {
    constexpr int kWidth = kWidthOf<V>;
    const double* from[3][4];
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) from[i][q] = rows.at[i][q] + begin;
    }
    double copy[3][4][kWidth + 1];
    if (begin + kWidth + 1 > rows.room) [[unlikely]] {
        for (int i = 0; i < 3; ++i) {
            for (int q = 0; q < 4; ++q) {
                for (int n = 0; n <= kWidth; ++n) {
                    copy[i][q][n] = from[i][q][n <= count ? n : count];
                }
                from[i][q] = copy[i][q];
            }
        }
    }
    CornerSums<V> c;
    V corner[8];
    const auto component = [&](int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            corner[2 * q] = load<V>(from[i][q]);
            corner[2 * q + 1] = load<V>(from[i][q] + 1);
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

// Where the forces on a run's corners go, likewise. `room`: particles from the beginning of each
// row on that may be written over with what they are.
struct CornerForces {
    double* at[3][4];
    int room[4];
};
SWAGE_INLINE CornerForces corner_forces(const RowSlab& slab, const ForceRows& to,
                                        const CellRun& run) {
    CornerForces rows;
    for (int q = 0; q < 4; ++q) {
        const ParticleId row = run.row[q];
        const bool is_own = row < slab.end;
        rows.room[q] = (is_own ? slab.end : slab.reach + kSeamRoom) - row;
        for (int i = 0; i < 3; ++i) {
            rows.at[i][q] = is_own ? to.own[i] + row : to.seam[i] + (row - slab.end);
        }
    }
    return rows;
}

// Forces of the two ends of a cell's edges along x meet on the particles between: they are added
// in registers, so that no particle is written twice in a row. What a batch leaves for the
// particle behind its last cell is carried to the next.
template <typename V>
struct ForceCarry {
    V high[3][4]{};
};

template <typename V>
SWAGE_INLINE void add_forces(const CornerSums<V>& r, const CornerForces& rows, int begin, int count,
                             ForceCarry<V>& carry) {
    constexpr int kWidth = kWidthOf<V>;
    typename LaneBatch<kWidth>::Indices lane, shift;
    for (int l = 0; l < kWidth; ++l) lane[l] = l, shift[l] = l + kWidth - 1;
    const auto component = [&](const V(&force)[8], int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            const V low = force[2 * q], high = force[2 * q + 1];
            const V from_left = __builtin_shuffle(carry.high[i][q], high, shift);
            carry.high[i][q] = high;
            double* to = rows.at[i][q] + begin;
            if (count >= kWidth) [[likely]] {
                store(V(load<V>(to) + (low + from_left)), to);
            } else {
                // Also the particle behind the run's last cell.
                const V sum = lane < count ? low + from_left : from_left;
                if (begin + kWidth <= rows.room[q]) {
                    const V old = load<V>(to);
                    store(V(lane <= count ? old + sum : old), to);
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
SWAGE_INLINE void add_carried(const CornerForces& rows, int end, const ForceCarry<V>& carry) {
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) rows.at[i][q][end] += carry.high[i][q][kWidthOf<V> - 1];
    }
}

}  // namespace swage
