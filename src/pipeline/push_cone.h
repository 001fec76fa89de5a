// SPDX-License-Identifier: GPL-3.0-or-later
// What contacts can bear is a cone: pushes along their normals and friction beside them. Whether it
// holds a force and torque is found by non-negative least squares (Lawson and Hanson, Solving Least
// Squares Problems, 1974).
#pragma once

#include <optional>
#include <vector>

#include "base/math.h"

namespace swage {

using Wrench = Eigen::Matrix<double, 6, 1>;  // [N], and torque over some length

// What is left of this by pushes, none of them less than nothing, that come nearest to it. None
// where they come to it within `enough`, or that is not found.
std::optional<Wrench> left_over(const std::vector<Wrench>& push, const Wrench& wanted,
                                double enough);

}  // namespace swage
