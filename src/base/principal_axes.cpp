// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace swage {

PrincipalAxes principal_axes(const Mat3& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(symmetric);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Vec3 principal_values(const Mat3& symmetric) {
    return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace swage
