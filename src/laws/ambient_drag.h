// SPDX-License-Identifier: GPL-3.0-or-later
// Drag of a thin medium that is at rest, such as air (S2.6), on a patch of surface:
//
//     F = -1/2 c rho (A / 4) |v| v      force on the patch [N]
//     D = 1/2 c rho (A / 4) |v|^3 / 3   dissipation potential [W], F = -dD/dv
//
// rho density of the medium [kg/m3], c drag coefficient of the whole body over a quarter of its
// surface (ball 0.5, a cube that goes face on 0.7), A area of the patch [m2], v its velocity [m/s].
//
// NOTE: the paper has F = -rho r^2 |v| v for particles of radius r, whatever the body's shape. Here
// r^2 is c A / 8: a convex body shows a quarter of its surface to the flow, in the mean over all
// directions (Cauchy 1832), so that a body in flight feels 1/2 c rho |v|^2 of its mean frontal
// area. All of the surface drags, whichever way it looks; laws/directional_drag.h is the other.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace swage {

struct AmbientDrag {
    double density;      // [kg/m3], >= 0
    double coefficient;  // >= 0
};

template <typename Number>
Eigen::Matrix<Number, 3, 1> ambient_drag_force(const AmbientDrag& drag, const Number& area,
                                               const Eigen::Matrix<Number, 3, 1>& velocity) {
    using std::sqrt;
    const Number speed = sqrt(velocity.dot(velocity));
    return (-0.125 * drag.coefficient * drag.density) * area * speed * velocity;
}

}  // namespace swage
