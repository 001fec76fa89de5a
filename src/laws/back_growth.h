// SPDX-License-Identifier: GPL-3.0-or-later
// How history and back stress of a cell (laws/cell_back.h) grow by a return:
//
//     A <- G = A exp(-E) exp(E') R^T,  E' = dev E after the return, of other axes than E
//     A q <- A q',  B <- R B' R^T,  A beta <- A beta'
//
// with the rotation R that makes G symmetric (laws/cell_growth.h): seen from there the strain is
// R E' R^T, so B turns along, and what stood on the yield surface stands on it.
#pragma once

#include "laws/cell_back.h"
#include "laws/cell_growth.h"

namespace swage {

template <typename N>
struct BackGrown {
    CellHistory<N> history;
    BackStrain<N> back;
};

template <typename N>
SWAGE_INLINE BackGrown<N> flowed_on(const CellHistory<N>& history, const BackStrain<N>& back,
                                    const BackFlowed<N>& r, const Columns<N>& f,
                                    const CornerSums<N>& c) {
    const Symmetric<N> a = taken_back(history);
    const Symmetric<N> after = r.kept * r.distortion + r.lent * back.strain;
    const Columns<N> grown = columns_of(a) * decay(r.distortion) * decay(-1.0 * after);
    const Symmetric<N> symmetric = made_symmetric(grown), next = of_volume_one(symmetric);
    const Symmetric<N> undone = inverse_of(next);
    const CellModes<N> all = pulled_back(f * next, c);
    // R^T = grown^-1 G, by columns.
    const Columns<N> turn = inverse_of(grown) * symmetric;
    const Symmetric<N> b = r.gained * r.distortion + r.held * back.strain;
    const Triple<N> x = b * turn.x, y = b * turn.y, z = b * turn.z;
    const auto along = [&](const Triple<N>& q) __attribute__((always_inline)) {
        return undone * (a * q);
    };
    const auto elastic = [&](const Triple<N>& q, const Triple<N>& beta)
        __attribute__((always_inline)) {
        return along(r.kept_modes * q + r.lent * beta);
    };
    const auto held = [&](const Triple<N>& q, const Triple<N>& beta)
        __attribute__((always_inline)) {
        return along((r.mode_flow * r.gained) * q + r.held * beta);
    };
    const CellModes<N>&q = r.modes, &beta = back.modes;
    return {
        {plus_unit(next, -1.0),
         {all.xy - elastic(q.xy, beta.xy), all.yz - elastic(q.yz, beta.yz),
          all.zx - elastic(q.zx, beta.zx), all.xyz - elastic(q.xyz, beta.xyz)},
         history.alpha + r.whole_d_alpha()},
        {{dot(turn.x, x), dot(turn.y, y), dot(turn.z, z), dot(turn.x, y), dot(turn.y, z),
          dot(turn.z, x)},
         {held(q.xy, beta.xy), held(q.yz, beta.yz), held(q.zx, beta.zx), held(q.xyz, beta.xyz)}}};
}

}  // namespace swage
