// SPDX-License-Identifier: GPL-3.0-or-later
// The shape in which a cell that has flowed (laws/cell.h) is at rest: its strain is nothing and its
// modes are p. But for a rotation
//
//     F = A^-1,  C = A^-2,  Q_m = p_m                   as seen from the material's centroid
//     x_c = A^-1 z_c,  so |x_b - x_a|^2 = z C z         z = z_b - z_a
#pragma once

#include "laws/cell.h"

namespace swage {

template <typename N>
struct CellRest {
    Symmetric<N> metric;  // C
    Triple<N> corner[8];  // z [m]
};

template <typename N>
SWAGE_INLINE Symmetric<N> flowed_metric(const Symmetric<N>& stretch) {
    return inverse_of(square(plus_unit(stretch, 1.0)));
}

// `at`: of the material's centroid, as centroid_sums() has it.
template <typename N>
SWAGE_INLINE CellRest<N> cell_rest(const CellHistory<N>& history, const Triple<N>& at,
                                   double spacing) {
    CellRest<N> r;
    r.metric = flowed_metric(history.stretch);
    const Symmetric<N> a = taken_back(history);
    const CellModes<N> g = {a * history.modes.xy, a * history.modes.yz, a * history.modes.zx,
                            a * history.modes.xyz};
    const CornerSums<N> none = {{}, {}, {}, g.xy, g.yz, g.zx, g.xyz};
    const Columns<N> levers = centroid_sums(none, at);
    const double side = 4 * spacing;
    N c[8];
    spread_corners(N(side - levers.x.x), N(-levers.y.x), N(-levers.z.x), g.xy.x, g.yz.x, g.zx.x,
                   g.xyz.x, c);
    for (int q = 0; q < 8; ++q) r.corner[q].x = 0.125 * c[q];
    spread_corners(N(-levers.x.y), N(side - levers.y.y), N(-levers.z.y), g.xy.y, g.yz.y, g.zx.y,
                   g.xyz.y, c);
    for (int q = 0; q < 8; ++q) r.corner[q].y = 0.125 * c[q];
    spread_corners(N(-levers.x.z), N(-levers.y.z), N(side - levers.z.z), g.xy.z, g.yz.z, g.zx.z,
                   g.xyz.z, c);
    for (int q = 0; q < 8; ++q) r.corner[q].z = 0.125 * c[q];
    return r;
}

// Of the connection between two corners, squared [m2].
template <typename N>
SWAGE_INLINE N rest_square(const CellRest<N>& rest, int low, int high) {
    const Triple<N> z = rest.corner[high] - rest.corner[low];
    return dot(z, rest.metric * z);
}

}  // namespace swage
