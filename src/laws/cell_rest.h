// SPDX-License-Identifier: GPL-3.0-or-later
// The shape in which a cell that has flowed (laws/cell.h) is at rest: its distortion is E_p, its
// volume what it was, and its modes are q_p. But for a rotation
//
//     C = U^2,  ln U = E_p,  det C = 1                  ln as laws/cell.h has it
//     F = U,  Q_m = U^-1 q_m                            as seen from the material's centroid
//     x_c = U z_c,  so |x_b - x_a|^2 = z C z            z = z_b - z_a
//
// No root of C is ever taken. With E = Y + Y^3/3 + Y^5/5 and C = (I + Y)(I - Y)^-1, Y is found by
//
//     Y = E (15 + E^2) / (15 + 6 E^2)                   to within E^7/7, 6e-8 at 0.1, 0.005 at 0.7
//     Y -= (Y + Y^3/3 + Y^5/5 - E) / (I + Y^2 + Y^4)    each step doubles the digits
//
// All of these are functions of E and commute.
#pragma once

#include "laws/cell.h"

namespace swage {

template <typename N>
struct CellRest {
    Symmetric<N> metric;  // C
    Triple<N> corner[8];  // z [m]
};

// |E_p| at the most: drawn to four times its length. The law's own ends at infinite stretch, 1.9.
inline constexpr double kMostFlowed = 1.6;

// C of a plastic strain, by kSteps steps of Newton's method.
template <int kSteps, typename N>
SWAGE_INLINE Symmetric<N> flowed_metric(const Symmetric<N>& flowed) {
    const N one = 1.0 + 0.0 * flowed.xx;
    const N norm = root(contract(flowed, flowed));
    const Symmetric<N> strain = (kMostFlowed / larger(norm, kMostFlowed * one)) * flowed;
    const Symmetric<N> e2 = square(strain);
    Symmetric<N> y = commuting(commuting(strain, plus_unit(e2, 15.0 * one)),
                               inverse_of(plus_unit(6.0 * e2, 15.0 * one)));
    for (int n = 0; n < kSteps; ++n) {
        const Symmetric<N> y2 = square(y), y4 = square(y2);
        const Symmetric<N> over = commuting(y, plus_unit((1.0 / 3) * y2 + 0.2 * y4, one)) - strain;
        y = y - commuting(over, inverse_of(plus_unit(y2 + y4, one)));
    }
    const Symmetric<N> c = plus_unit(
        2.0 * inverse_of(Symmetric<N>{1.0 - y.xx, 1.0 - y.yy, 1.0 - y.zz, -y.xy, -y.yz, -y.zx}),
        -one);
    // The law's logarithm has a trace that is not quite ln J. det C^(-1/3), which is nearly one.
    const N det = determinant(c, cofactors(c));
    N scale = one;
    for (int n = 0; n < 4; ++n) scale = (1.0 / 3) * scale * (4.0 - det * scale * scale * scale);
    return scale * c;
}

// `at`: of the material's centroid, as centroid_sums() has it.
template <int kSteps, typename N>
SWAGE_INLINE CellRest<N> cell_rest(const CellHistory<N>& history, const Triple<N>& at,
                                   double spacing) {
    CellRest<N> r;
    r.metric = flowed_metric<kSteps>(history.strain);
    const Symmetric<N> back = inverse_of(r.metric);
    const CellModes<N> g = {back * history.modes.xy, back * history.modes.yz,
                            back * history.modes.zx, back * history.modes.xyz};
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
