// SPDX-License-Identifier: GPL-3.0-or-later
// How the history of a cell (laws/cell.h) grows by a return:
//
//     A <- root of A exp(-2 D) A,  D = (1 - w) dev E       det A = 1
//     A q <- w A q,  q = (F A)^T Q - p                     gives p
//
// exp(-D) = B is the square of Pade's (1 + x/2 + x^2/12) / (1 - x/2 + x^2/12), x = -D/2, to within
// 2 |x|^5 / 720: 3e-8 where D is 0.2. The root is A B R^T with the rotation R that makes it
// symmetric; it is found as polar decompositions are, by the axis w of (tr S - S) w = 2 k, where S
// and k are the symmetric part and the axis of the other. A q, and so W_q but for what bends
// across, goes on as it was: q are modes of the edges A^-1 e_i, which flow along.
#pragma once

#include "laws/cell.h"

namespace swage {

template <typename N>
SWAGE_INLINE Columns<N> columns_of(const Symmetric<N>& s) {
    return {{s.xx, s.xy, s.zx}, {s.xy, s.yy, s.yz}, {s.zx, s.yz, s.zz}};
}

// exp(-d), d without a trace.
template <typename N>
SWAGE_INLINE Symmetric<N> decay(const Symmetric<N>& d) {
    const Symmetric<N> x = -0.5 * d, even = plus_unit((1.0 / 12) * square(x), 1.0);
    return square(commuting(even + 0.5 * x, inverse_of(even - 0.5 * x)));
}

// The symmetric m R^T, R a rotation that is not far.
template <typename N>
SWAGE_INLINE Symmetric<N> made_symmetric(Columns<N> m) {
    constexpr int kRounds = 4;
    for (int n = 0; n < kRounds; ++n) {
        const Symmetric<N> s = {m.x.x,
                                m.y.y,
                                m.z.z,
                                0.5 * (m.x.y + m.y.x),
                                0.5 * (m.y.z + m.z.y),
                                0.5 * (m.x.z + m.z.x)};
        const Triple<N> k = {m.y.z - m.z.y, m.z.x - m.x.z, m.x.y - m.y.x};
        const N t = trace(s);
        const Symmetric<N> over = inverse_of(
            Symmetric<N>{t - s.xx, t - s.yy, t - s.zz, -1.0 * s.xy, -1.0 * s.yz, -1.0 * s.zx});
        // Rows of m are turned by twice the arc tangent of |h| about h.
        const Triple<N> h = 0.5 * (over * k);
        const N share = 2.0 / (1.0 + dot(h, h));
        const auto turned = [&](const Triple<N>& row) __attribute__((always_inline)) {
            return row + share * cross(h, row + cross(h, row));
        };
        const Triple<N> x = turned({m.x.x, m.y.x, m.z.x}), y = turned({m.x.y, m.y.y, m.z.y}),
                        z = turned({m.x.z, m.y.z, m.z.z});
        m = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
    }
    return {
        m.x.x, m.y.y, m.z.z, 0.5 * (m.x.y + m.y.x), 0.5 * (m.y.z + m.z.y), 0.5 * (m.x.z + m.z.x)};
}

// Times det^(-1/3), which is nearly one.
template <typename N>
SWAGE_INLINE Symmetric<N> of_volume_one(const Symmetric<N>& grown) {
    const N det = determinant(grown, cofactors(grown));
    N scale = 1.0 + 0.0 * det;
    for (int n = 0; n < 3; ++n) scale = (1.0 / 3) * scale * (4.0 - det * scale * scale * scale);
    return scale * grown;
}
// A after a flow of d.
template <typename N>
SWAGE_INLINE Symmetric<N> flowed_on(const Symmetric<N>& a, const Symmetric<N>& d) {
    return of_volume_one(made_symmetric(columns_of(a) * decay(d)));
}

// The history after the return `r` of a cell of gradient f.
template <typename N>
SWAGE_INLINE CellHistory<N> flowed_on(const CellHistory<N>& history, const CellFlowed<N>& r,
                                      const Columns<N>& f, const CornerSums<N>& c) {
    const Symmetric<N> a = taken_back(history), next = flowed_on(a, (1.0 - r.kept) * r.distortion);
    const Symmetric<N> back = inverse_of(next);
    const auto elastic = [&](const Triple<N>& q) __attribute__((always_inline)) {
        return back * (a * (r.kept_modes * q));
    };
    const CellModes<N> all = pulled_back(f * next, c);
    return {plus_unit(next, -1.0),
            {all.xy - elastic(r.modes.xy), all.yz - elastic(r.modes.yz),
             all.zx - elastic(r.modes.zx), all.xyz - elastic(r.modes.xyz)},
            history.alpha + r.whole_d_alpha()};
}

}  // namespace swage
