// SPDX-License-Identifier: GPL-3.0-or-later
// Principal values and axes of symmetric matrices. Eigen's solver takes two seconds to compile
// wherever it is named, so it is named here.
#pragma once

#include "base/math.h"

namespace swage {

struct PrincipalAxes {
    Vec3 value;  // ascending
    Mat3 axis;   // columns of length 1
};
PrincipalAxes principal_axes(const Mat3& symmetric);

// The values alone, ascending.
Vec3 principal_values(const Mat3& symmetric);

}  // namespace swage
