// SPDX-License-Identifier: GPL-3.0-or-later
// Internal damping of a material that loses the same share of its energy in every swing, however
// slow: along each connection, beside its spring of stiffness k, stand branches of a spring and a
// dashpot in line (a generalised Maxwell body, one decade of time apart),
//
//     dq_j/dt = D_j k v - q_j / tau_j         tension of branch j [N]
//     T = sum of q_j                          added to the connection's tension
//     W = sum of q_j^2 / (2 D_j k)            energy stored [J]
//     P = sum of q_j^2 / (D_j k tau_j)        power taken [W]
//
// v rate of the connection's length [m/s]; D_j stiffness over k, tau_j relaxation time [s].
//
// Swinging at the angular frequency w, with x = w tau,
//
//     loss(w) = sum D_j x / (1 + x^2) / (1 + sum D_j x^2 / (1 + x^2)),   zeta = loss / 2.
//
// D is such that zeta is the damping ratio at each w = 1 / tau_j; between them it is up to 12 %
// less, and at the highest ratio 19 % less to 30 % more. At rest the branches carry nothing, so
// Young's modulus is that of slow loading; what swings is stiffer, as matter that loses energy is.
//
// The branches of a connection that softens (laws/fracture.h) soften with it: else slow ones would
// hold a crack together long after its springs have let go.
//
// What flows takes its branches along: v is less the rate of the rest length, else they would hold
// matter by a share of all of its strain, many times what it yields at. And q_j fades as
// exp(-p / e_y) with the strain p that flows and that at yield, e_y: matter that has flowed is not
// what the branches were strained with. Without that it would yield later by up to the sum of D_j
// for as long as the slowest branch holds.
//
// Sources: S2.4 has one dashpot a connection, which damps each mode in proportion to its frequency:
// right for one mode, and next to nothing for a slender body's slow ones. H.-P. Liu, D. L.
// Anderson, H. Kanamori, Geophys. J. R. astr. Soc. 47, 41 (1976); H. Emmerich, M. Korn, Geophysics
// 52, 1252 (1987).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/portable_math.h"

namespace swage {

inline constexpr int kMostBranches = 5;
// Beyond, branches a decade apart cannot take more.
inline constexpr double kMostDampingRatio = 0.3;

struct DampingBranches {
    int count = 0;                              // 0: no damping
    std::array<double, kMostBranches> share{};  // D
    std::array<double, kMostBranches> time{};   // tau [s], from short to long
};

// 2 zeta at an angular frequency [rad/s].
inline double loss_factor(const DampingBranches& branches, double frequency) {
    double loss = 0, stiff = 1;
    for (int j = 0; j < branches.count; ++j) {
        const double x = frequency * branches.time[j], share = branches.share[j] / (1 + x * x);
        loss += share * x;
        stiff += share * x * x;
    }
    return loss / stiff;
}

// Stiffness of what moves too fast for any branch to give way, over that at rest.
inline double fast_stiffness(const DampingBranches& branches) {
    double stiff = 1;
    for (int j = 0; j < branches.count; ++j) stiff += branches.share[j];
    return stiff;
}

// The ratio (0 to kMostDampingRatio) holds from `high` down to `low` [rad/s], or as far as the
// branches reach.
inline DampingBranches damping_branches(double ratio, double low, double high) {
    DampingBranches branches;
    if (!(ratio > 0)) return branches;
    const double decades = portable::log10(std::max(1.0, high / low));
    branches.count = std::clamp(1 + static_cast<int>(std::ceil(decades)), 2, kMostBranches);
    for (int j = 0; j < branches.count; ++j) {
        branches.time[j] = portable::pow(10.0, j) / high;
        branches.share[j] = 3 * ratio;
    }
    constexpr int kRounds = 300;  // each branch in turn, until all agree
    for (int round = 0; round < kRounds; ++round) {
        for (int j = branches.count - 1; j >= 0; --j) {
            const double now = loss_factor(branches, 1 / branches.time[j]);
            branches.share[j] *= std::clamp(2 * ratio / now, 0.5, 2.0);
        }
    }
    return branches;
}

// (1 - exp(-x)) / x for x >= 0.
inline double mean_decay(double x) { return x > 0 ? -portable::expm1(-x) / x : 1; }

// One branch over a step, in shares of the connection's stiffness and length l: m = q / (k l), with
// the strain v step / l that the step added. Exact for a steady rate.
struct DampingStep {
    double keep, gain;  // m = keep m + gain strain
};
inline DampingStep damping_step(const DampingBranches& branches, int j, double step) {
    const double share = step / branches.time[j];
    return {portable::exp(-share), branches.share[j] * mean_decay(share)};
}

}  // namespace swage
