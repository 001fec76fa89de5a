// SPDX-License-Identifier: GPL-3.0-or-later
// The constants of the cell law (laws/cell.h).
#pragma once

#include <cmath>

#include "base/portable_math.h"
#include "laws/flow_curve.h"

namespace swage {

// f^2, a partly filled cell's deviations over its mean strain, is never taken below this: with
// less, slivers flap about and no solver is quick. 0.001 changes the stiffness of oblique bars 4
// cells across by 0.1 % from this.
inline constexpr double kLeastModeFill = 0.03;
// Modes of cells that are filled by less flow by themselves. All corners that went off (mode_flow())
// were of cells up to this.
inline constexpr double kFlowingFill = 0.06;
// And at so many times the yield stress where other cells of the body are fuller; bodies that have
// no fuller ones than this are walls whose bending is all they have.
inline constexpr double kSliverStrength = 10, kThinFill = 0.15;

// One material at one spacing.
struct CellModuli {
    double spacing;       // a [m]
    double shear;         // mu [Pa]
    double bulk;          // K [Pa]
    double edge;          // c_e [N/m]
    double diagonal;      // c_d [N/m]
    double yield_stress;  // sigma_y [Pa], finite
    double hardening;     // H [Pa]
    double foam_power;    // m of laws/cell_foam.h
    double foam_least;    // J below which that law goes on in a straight line
    FlowCurve curve;      // instead of sigma_y + H alpha where it is not empty
    // laws/cell_back.h: X_s [Pa], 0: none; gamma.
    double back_stress = 0, back_rate = 0;
    double sliver_strength = kSliverStrength;  // see there
};

inline constexpr double kMostStiffened = 1000;

inline CellModuli cell_moduli(double young_modulus, double poisson_ratio, double spacing,
                              double yield_stress = 0, double hardening = 0,
                              const std::vector<FlowPoint>& curve = {}) {
    const double mu = young_modulus / (2 * (1 + poisson_ratio));
    const double m = 1 / (1 - 2 * poisson_ratio);
    const double edge =
        (poisson_ratio + std::sqrt((1 + poisson_ratio) * (1 + poisson_ratio) + 1)) / 3;
    return {spacing,
            mu,
            young_modulus / (3 * (1 - 2 * poisson_ratio)),
            mu * spacing * edge / 16,
            mu * spacing / 48,
            yield_stress,
            hardening,
            m,
            portable::pow(kMostStiffened, -1 / (m + 1)),
            flow_curve(curve, mu)};
}

}  // namespace swage
