// SPDX-License-Identifier: GPL-3.0-or-later
// Neither springs nor a strain of C = F^T F know inside from outside: a mirrored cell is as content
// as the cell, and on the way there the log law drives it on. Below half of its volume a cell
// therefore also resists by its volume, and more once it is inside out:
//
//     W = E (1/2 - J)^2 / 2  [J < 1/2]  +  30 E J^2 / 2  [J < 0]     per volume at molding [J/m3]
//     P = dW/dF = W'(J) cof F                                        [Pa]
//
// J = det F. 30 outweighs the log law's push wherever it points the wrong way. Nothing above half
// the volume feels it, so it changes no answer that can be trusted.
#pragma once

namespace swage {

inline constexpr double kGuardedVolume = 0.5;
inline constexpr double kMirroredStiffness = 30;

inline double guard_energy(double young_modulus, double volume_ratio) {
    const double lost = kGuardedVolume - volume_ratio;
    if (!(lost > 0)) return 0;
    const double mirrored = volume_ratio < 0 ? volume_ratio : 0;
    return 0.5 * young_modulus * (lost * lost + kMirroredStiffness * mirrored * mirrored);
}

// dW/dJ [Pa]: minus the pressure with which the cell holds against being crushed.
inline double guard_slope(double young_modulus, double volume_ratio) {
    const double lost = kGuardedVolume - volume_ratio;
    if (!(lost > 0)) return 0;
    const double mirrored = volume_ratio < 0 ? volume_ratio : 0;
    return young_modulus * (kMirroredStiffness * mirrored - lost);
}

}  // namespace swage
