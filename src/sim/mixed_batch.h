// SPDX-License-Identifier: GPL-3.0-or-later
// How cells of two materials are read, several at a time or alone.
#pragma once

#include <algorithm>
#include <span>

#include "laws/laminate.h"
#include "matter/aggregate.h"
#include "sim/mixed_cells.h"

namespace swage {

template <typename N>
SWAGE_INLINE void set_lane(N& v, int lane, double to) {
    v[lane] = to;
}
SWAGE_INLINE void set_lane(double& v, int, double to) { v = to; }

// Lane of a batch, or all there is of a number.
template <typename N>
SWAGE_INLINE void read_mixed(const Vec3Array& x, const MixedCell& cell,
                             const std::array<ParticleId, 8>& corner, int lane, N (&at)[3][8],
                             Phase<N> (&phase)[2], Triple<N>& normal, Triple<N>& jump) {
    for (int c = 0; c < 8; ++c) {
        set_lane(at[0][c], lane, x.x[corner[c]]);
        set_lane(at[1][c], lane, x.y[corner[c]]);
        set_lane(at[2][c], lane, x.z[corner[c]]);
    }
    set_lane(normal.x, lane, cell.normal.x());
    set_lane(normal.y, lane, cell.normal.y());
    set_lane(normal.z, lane, cell.normal.z());
    set_lane(jump.x, lane, cell.jump.x());
    set_lane(jump.y, lane, cell.jump.y());
    set_lane(jump.z, lane, cell.jump.z());
    for (int p = 0; p < 2; ++p) {
        Phase<N>& m = phase[p];
        set_lane(m.fill, lane, cell.fill[p]);
        set_lane(m.at.x, lane, 2 * cell.centroid[p].x());
        set_lane(m.at.y, lane, 2 * cell.centroid[p].y());
        set_lane(m.at.z, lane, 2 * cell.centroid[p].z());
        for_each_number(
            m.history, [&](int n, N& number) __attribute__((always_inline)) {
                set_lane(number, lane, cell.flowed[p][n]);
            });
    }
}

// The cells of one batch, which are of the same two materials.
struct MixedBatch {
    const Aggregate& matter;
    std::span<const int> cell;  // into mixed_cell
    const std::array<ParticleId, 8>* corner;
    const MaterialLaw* law[2];

    int count() const { return static_cast<int>(cell.size()); }
};
inline MixedBatch mixed_batch(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                              const MixedBatches& all, std::size_t n) {
    const std::size_t begin = all.first[n], count = all.first[n + 1] - begin;
    const auto& [one, other] = matter.mixed_cell[all.cell[begin]].material;
    return {matter,
            std::span(all.cell).subspan(begin, count),
            &all.corner[begin],
            {&laws[one], &laws[other]}};
}

// So many of its cells from one on, as their law sees them.
template <int kWidth>
struct MixedLanes {
    typedef LanesOf<kWidth> V;
    CornerSums<V> sums;
    Phase<V> phase[2]{};
    Triple<V> normal{};
    Triple<V> jump{};  // committed

    SWAGE_INLINE MixedLanes(const MixedBatch& batch, int begin) {
        V at[3][8]{};
        for (int p = 0; p < 2; ++p) {
            phase[p].law = &batch.law[p]->moduli, phase[p].kind = batch.law[p]->kind;
        }
        for (int l = 0; l < kWidth; ++l) {
            const int n = cell_of(batch, begin, l);
            read_mixed(batch.matter.particle_position, batch.matter.mixed_cell[batch.cell[n]],
                       batch.corner[n], l, at, phase, normal, jump);
        }
        sums = sum_corners(at);
    }
    // Lanes that are left over repeat the last cell.
    static int cell_of(const MixedBatch& batch, int begin, int lane) {
        return std::min(begin + lane, batch.count() - 1);
    }
};

}  // namespace swage
