// SPDX-License-Identifier: GPL-3.0-or-later
// What a back stress (laws/cell_back.h) leaves of a flow curve for the part that grows alike in
// every direction, R(p) = sigma(p) - X_s (1 - exp(-p / p_s)): where that is least.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "base/portable_math.h"
#include "laws/flow_curve.h"

namespace swage {

// Of the curve, or where that is empty of yield_stress + hardening p; the strain may be infinite.
inline FlowPoint least_isotropic(double yield_stress, double hardening,
                                 const std::vector<FlowPoint>& curve, double back_stress,
                                 double back_strain) {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    FlowPoint least{0, yield_stress};
    // On a line R has one lowest place.
    const auto look = [&](double from, double to, double stress, double slope) {
        const double steep = back_stress / back_strain;
        const double lowest = !(slope > 0)    ? kEndless
                              : slope > steep ? 0
                                              : back_strain * portable::log(steep / slope);
        const double at = std::clamp(lowest, from, to);
        const double here = at == kEndless ? stress - back_stress
                                           : stress + slope * (at - from) +
                                                 back_stress * portable::expm1(-at / back_strain);
        if (here < least.stress) least = {at, here};
    };
    if (curve.empty()) look(0, kEndless, yield_stress, hardening);
    for (std::size_t n = 0; n < curve.size(); ++n) {
        const auto& [strain, stress] = curve[n];
        const bool last = n + 1 == curve.size();
        look(strain, last ? kEndless : curve[n + 1].strain, stress,
             last ? 0 : (curve[n + 1].stress - stress) / (curve[n + 1].strain - strain));
    }
    return least;
}

}  // namespace swage
