// SPDX-License-Identifier: GPL-3.0-or-later
// How cells of two materials are read, several at a time or alone.
#pragma once

#include "laws/laminate.h"
#include "matter/aggregate.h"

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
                             Phase<N> (&phase)[2], Triple<N>& normal) {
    for (int c = 0; c < 8; ++c) {
        set_lane(at[0][c], lane, x.x[corner[c]]);
        set_lane(at[1][c], lane, x.y[corner[c]]);
        set_lane(at[2][c], lane, x.z[corner[c]]);
    }
    set_lane(normal.x, lane, cell.normal.x());
    set_lane(normal.y, lane, cell.normal.y());
    set_lane(normal.z, lane, cell.normal.z());
    for (int p = 0; p < 2; ++p) {
        Phase<N>& m = phase[p];
        set_lane(m.fill, lane, cell.fill[p]);
        set_lane(m.at.x, lane, 2 * cell.centroid[p].x());
        set_lane(m.at.y, lane, 2 * cell.centroid[p].y());
        set_lane(m.at.z, lane, 2 * cell.centroid[p].z());
        const auto number = numbers_of(m.history);
        for (int n = 0; n < kCellHistory; ++n) set_lane(*number[n], lane, cell.flowed[p][n]);
    }
}

}  // namespace swage
