// SPDX-License-Identifier: GPL-3.0-or-later
// Foam, which may be pressed together far and keeps its Poisson's ratio meanwhile:
//
//     W = f V mu/2 [|F|^2 - 3 + 2 (J^(1-m) - 1) / (m - 1)] + f^3 W_q         [J]
//     dW/dF = f V mu [F - J^-m cof F]         J = det F, m = 1 / (1 - 2 nu)
//
// W_q as in laws/cell.h. Pulled or pressed along one axis to s, matter is s^-nu as wide: its stress
// there is mu (s - s^(-1 - 2 nu)), small or large, and without end where s goes to nothing.
//
// Source: B. Storakers, "On material representation and constitutive branching in finite
// compressible elasticity", J. Mech. Phys. Solids 34, 1986, with one term of exponent 2, which
// needs no principal stretches.
//
// NOTE: below the volume where the law is kMostStiffened times as stiff as at rest, J^-m goes on in
// a straight line: what is crushed or inside out comes back with a finite force.
#pragma once

#include <cmath>

#include "base/portable_math.h"
#include "laws/cell_moduli.h"
#include "laws/lane_power.h"

namespace swage {

// J^-m.
template <typename N>
SWAGE_INLINE N foam_pressure(const CellModuli& law, const N& volume) {
    const N least = larger(volume, law.foam_least + 0.0 * volume);
    const N p = power(least, -law.foam_power);
    return p - (law.foam_power * p / least) * (volume - least);
}
template <typename N>  // dW/dF per volume of material [Pa]
SWAGE_INLINE Columns<N> foam_stress(const CellModuli& law, const Columns<N>& f) {
    const Columns<N> cofactor = {cross(f.y, f.z), cross(f.z, f.x), cross(f.x, f.y)};
    const N pressure = (-law.shear) * foam_pressure(law, dot(f.x, cofactor.x));
    return {law.shear * f.x + pressure * cofactor.x, law.shear * f.y + pressure * cofactor.y,
            law.shear * f.z + pressure * cofactor.z};
}

// Minus the integral of J^-m from 1 on.
inline double foam_volume_energy(const CellModuli& law, double volume) {
    const double m = law.foam_power, least = larger(volume, law.foam_least);
    const double beyond = volume - least, log = portable::log(least);
    const double whole = m == 1 ? -log : portable::expm1((1 - m) * log) / (m - 1);
    const double p = portable::exp(-m * log);
    return whole - p * beyond + 0.5 * m * p / least * beyond * beyond;
}
template <LaneVector V>
SWAGE_INLINE V foam_volume_energy(const CellModuli& law, const V& volume) {
    V r;
    for (int l = 0; l < kWidthOf<V>; ++l) r[l] = foam_volume_energy(law, volume[l]);
    return r;
}
template <typename N>  // per volume of material [J/m3]
SWAGE_INLINE N foam_energy(const CellModuli& law, const Columns<N>& f) {
    const N squares = dot(f.x, f.x) + dot(f.y, f.y) + dot(f.z, f.z);
    return law.shear * (0.5 * (squares - 3.0) + foam_volume_energy(law, dot(f.x, cross(f.y, f.z))));
}

// The most that it is stiffer by than at rest, of a cell of gradient columns' squares `stretch` and
// cofactors' squares `area`, each summed [Pa].
inline double foam_stiffening(const CellModuli& law, double volume, double stretch, double area) {
    const double least = larger(volume, law.foam_least);
    const double p = power(least, -law.foam_power);
    return law.shear *
           larger(0, law.foam_power * (p / least * area - 3) +
                         foam_pressure(law, volume) * std::sqrt(stretch) - std::sqrt(3.0));
}

}  // namespace swage
