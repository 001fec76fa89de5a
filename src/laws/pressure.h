// SPDX-License-Identifier: GPL-3.0-or-later
// A fluid's pressure on a surface that moves and deforms (a follower load):
//
//     a = J F^-T N A = cof(F) N A      present area vector [m2] (Nanson)
//     f = -p a                         force on the surface [N]
//
// p pressure [Pa], N unit outward normal and A area [m2] at molding, F deformation gradient at the
// surface, J its determinant. On a closed surface the work of f is -p dV, V the volume enclosed.
// cof(F) has the cross products of the columns of F as its columns, so nothing is divided by.
//
// Source: e.g. J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis,
// 2nd ed. (2008), 4.3 and 8.5.2.
#pragma once

#include <Eigen/Geometry>

namespace swage {

template <typename Number>
Eigen::Matrix<Number, 3, 1> present_area(const Eigen::Matrix<Number, 3, 3>& gradient,
                                         const Eigen::Matrix<Number, 3, 1>& reference_area) {
    const Eigen::Matrix<Number, 3, 1> x = gradient.col(0), y = gradient.col(1), z = gradient.col(2);
    return y.cross(z) * reference_area[0] + z.cross(x) * reference_area[1] +
           x.cross(y) * reference_area[2];
}

template <typename Number>
Eigen::Matrix<Number, 3, 1> pressure_force(const Number& pressure,
                                           const Eigen::Matrix<Number, 3, 1>& present_area) {
    return -pressure * present_area;
}

}  // namespace swage
