// SPDX-License-Identifier: GPL-3.0-or-later
// Springs alone do not know inside from outside: a mirrored cell is as content as the cell. Below
// half of its volume a cell therefore also resists by its volume:
//
//     W = E (1/2 - J)^2 / 2  per volume at molding, J = det F < 1/2     [J/m3]
//     P = dW/dF = -E (1/2 - J) cof F                                    [Pa]
//
// Nothing above half the volume feels it, so it changes no answer that can be trusted.
#pragma once

namespace swage {

inline constexpr double kGuardedVolume = 0.5;

inline double guard_energy(double young_modulus, double volume_ratio) {
    const double lost = kGuardedVolume - volume_ratio;
    return lost > 0 ? 0.5 * young_modulus * lost * lost : 0;
}

// dW/dJ [Pa]: minus the pressure with which the cell holds against being crushed.
inline double guard_slope(double young_modulus, double volume_ratio) {
    const double lost = kGuardedVolume - volume_ratio;
    return lost > 0 ? -young_modulus * lost : 0;
}

}  // namespace swage
