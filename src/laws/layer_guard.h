// SPDX-License-Identifier: GPL-3.0-or-later
// What a material that shares its cell with another resists with once it is crushed more than the
// cell is. The cell's own guard (laws/volume_guard.h) knows only the whole: a soft layer takes up
// all that stiff matter beside it does not give way by, and a sixth of a cell is pressed to nothing
// before the cell has lost a fifth of its volume. Its law's push fades on the way there, and draws
// on the other side, where it is inside out. Below half of its volume it therefore also has
//
//     W = M (V - x)^3 / x                         per volume at molding [J/m3]
//     M = K + 4 mu / 3,   x = J + d^2 / (d + V/2),   d = V - J_c, 0 above V
//
// J = det F of the material, J_c that of the cell where it lies, without a jump; V as the cell's
// guard has it. Matter that is strained as the whole cell is, however far, inside out too, stays
// above x = V/2 and is left to the cell's guard. W is convex in x, which is linear in the jump a,
//
//     det(F + a n^T) = det F + a . cof F n,
//
// and more so than the law of laws/cell.h falls off: confined, both together push with 3.6 and 13
// times M at a quarter and a tenth of the thickness, where ln s / s has 5.5 and 23.
//
// NOTE: below x = V/25 it goes on as its square there: searches look beyond, and are to come back.
#pragma once

#include <algorithm>

#include "laws/cell_forces.h"
#include "laws/dual.h"
#include "laws/volume_guard.h"

namespace swage {

// V: foam is left alone as far as its own law goes before it goes straight on.
inline double guarded_volume(CellKind kind, const CellModuli& law) {
    return kind == CellKind::foam ? std::min(law.foam_least, kGuardedVolume) : kGuardedVolume;
}

SWAGE_INLINE bool any_below(double volume, double limit) { return volume < limit; }
template <LaneVector V>
SWAGE_INLINE bool any_below(const V& volume, double limit) {
    return is_any(volume < limit);
}
template <typename N>
SWAGE_INLINE bool any_below(const Dual<N>& volume, double limit) {
    return any_below(volume.value, limit);
}

template <typename N>
struct LayerGuard {
    N energy;       // W / M
    N slope;        // of it with J
    N whole_slope;  // and with J_c
};

template <typename N>
SWAGE_INLINE LayerGuard<N> guard_layer(double whole, const N& volume, const N& of_cell) {
    constexpr double kStraight = 0.04;  // of V
    const double room = 0.5 * whole;
    const N none = 0.0 * volume;
    const N lost = larger(whole - of_cell, none), over = 1.0 / (lost + room);
    const N u = (1.0 / whole) * (volume + lost * lost * over);
    // At `at`, and from there on by what is left.
    const N at = larger(-1.0 * larger(-1.0 * u, none - 1.0), kStraight + none);
    const N left = -1.0 * larger(at - u, none);
    const N one = 1.0 - at, part = 1.0 / at, bend = 2.0 * part * part * part - 2.0;
    const N first = 3.0 - part * part - 2.0 * at;
    const N slope = whole * (first + bend * left);
    const N energy =
        (whole * whole) * (one * one * one * part + left * (first + 0.5 * bend * left));
    return {energy, slope, -1.0 * slope * lost * (lost + whole) * over * over};
}

}  // namespace swage
