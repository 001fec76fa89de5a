// SPDX-License-Identifier: GPL-3.0-or-later
// Drag of a slow flow on the surface that meets it (S0.6), on a patch of surface:
//
//     F = -k A (v.n) v / |v|   where v.n > 0, else 0      force on the patch [N]
//
// k drag [Pa s/m], A area of the patch [m2], v its velocity [m/s], n its unit outward normal: of a
// particle that moves at |v| only the share v.n / |v| is in the way.
//
// NOTE: this force stands against the motion, so it turns and slows a body that falls without
// turning, and never drives it aside. What a smooth surface feels that the medium cannot drag along
// is the same along the normal,
//
//     F = -k A (v.n) n,        D = 1/2 k A (v.n)^2, F = -dD/dv,
//
// under which a tilted plate slides off sideways.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace swage {

enum class DragAlong { motion, normal };

struct DirectionalDrag {
    double drag;  // k [Pa s/m], >= 0
    DragAlong along;
};

template <typename Number>
Eigen::Matrix<Number, 3, 1> directional_drag_force(const DirectionalDrag& law, const Number& area,
                                                   const Eigen::Matrix<Number, 3, 1>& velocity,
                                                   const Eigen::Matrix<Number, 3, 1>& normal) {
    using std::sqrt;
    const Number onward = velocity.dot(normal);
    if (!(onward > 0)) return Eigen::Matrix<Number, 3, 1>::Zero();
    const Number size = law.drag * area * onward;
    if (law.along == DragAlong::normal) return -size * normal;
    return -(size / sqrt(velocity.dot(velocity))) * velocity;
}

}  // namespace swage
