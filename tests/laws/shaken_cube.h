// SPDX-License-Identifier: GPL-3.0-or-later
// A cell's eight corners, their sums, and where they may go.
#pragma once

#include <Eigen/Geometry>
#include <random>

#include "base/math.h"
#include "laws/cell.h"
#include "tests/catch.h"

namespace swage::test {

constexpr double kSpacing = 0.3, kVolume = kSpacing * kSpacing * kSpacing;

using Corners = Eigen::Matrix<double, 3, 8>;

inline Corners cube() {
    Corners x;
    for (int c = 0; c < 8; ++c) x.col(c) = kSpacing * Vec3(c & 1, c >> 1 & 1, c >> 2);
    return x;
}

inline CornerSums<double> sums_of(const Corners& x) {
    double at[3][8];
    for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 8; ++c) at[i][c] = x(i, c);
    }
    return sum_corners(at);
}

inline Corners forces_of(const CornerSums<double>& r) {
    Corners f;
    double own[3][8];
    spread_corners(r, own);
    for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 8; ++c) f(i, c) = own[i][c];
    }
    return f;
}

// That they are minus the gradient of the energy there, and neither push nor turn the cell itself.
template <typename Energy>
void check_forces(const Energy& energy, const Corners& x, const Corners& f) {
    Corners slope;
    const double h = 1e-4 * kSpacing;
    for (int i = 0; i < 24; ++i) {
        const auto at = [&](double by) {
            Corners moved = x;
            moved.reshaped()[i] += by;
            return energy(moved);
        };
        slope.reshaped()[i] = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    }
    CHECK((f + slope).norm() < 1e-8 * f.norm());
    CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
    Vec3 torque = Vec3::Zero();
    for (int c = 0; c < 8; ++c) torque += Vec3(x.col(c)).cross(Vec3(f.col(c)));
    CHECK(torque.norm() < 1e-12 * f.norm() * kSpacing);
}

class Draw {
  public:
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    Corners shaken(double by) {
        Corners x = cube();
        for (double& v : x.reshaped()) v += by * kSpacing * (*this)(-1, 1);
        return x;
    }
    Mat3 turn() {
        const Vec3 axis((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
        return Eigen::AngleAxisd((*this)(-3, 3), axis.normalized()).toRotationMatrix();
    }

  private:
    std::mt19937 engine_{7};
};

}  // namespace swage::test
