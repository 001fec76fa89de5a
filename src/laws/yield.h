// SPDX-License-Identifier: GPL-3.0-or-later
// Perfectly plastic connection: beyond its yield strain the rest_length follows.
//
//     e_e = e - e_p                elastic strain, e = d / reference_length - 1
//     |e_e| <= e_y                 else e_p moves so that |e_e| = e_y
//
// The history e_p has a committed value; every evaluation returns from it and leaves no trace, so
// that only converged states are remembered.
//
// Yield strains: e_y = sigma_y / E along the edges. Under uniaxial stress with Poisson's ratio 1/4
// a face diagonal strains by (1 - 1/4) / 2 of that, so diagonals yield at 0.375 sigma_y / E.
// NOTE: connection-wise yield is right in tension and bending along the lattice axes, about 48 %
// too weak in pure shear, and flows under pressure too; a law on the whole cell cures both.
#pragma once

#include <algorithm>

namespace swage {

inline constexpr double kDiagonalYieldShare = 0.375;

// The elastic strain after the return.
template <typename Number>
Number returned_strain(const Number& strain, const Number& committed_plastic, double yield_strain) {
    const Number trial = strain - committed_plastic;
    return std::min(std::max(trial, Number(-yield_strain)), Number(yield_strain));
}

// What to commit once the state has converged.
template <typename Number>
Number committed_plastic_strain(const Number& strain, const Number& plastic, double yield_strain) {
    return strain - returned_strain(strain, plastic, yield_strain);
}

// Work lost to plastic flow by a move of the plastic strain, per stiffness * reference_length^2:
// the stress stays at the limit while the strain flows.
inline double plastic_work(double plastic_before, double plastic_after, double yield_strain) {
    const double flow = plastic_after - plastic_before;
    return flow < 0 ? -flow * yield_strain : flow * yield_strain;
}

}  // namespace swage
