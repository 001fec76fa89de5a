// SPDX-License-Identifier: GPL-3.0-or-later
// What the corners of a cell bear of a point that it carries (SurfacePoints::weight).
#pragma once

#include <array>
#include <cmath>

#include "base/math.h"

namespace swage {

// A cell filled less than this does not carry surface where a fuller one lies within reach: pressed
// hard, the far corners of a sliver, which hardly anything holds, are driven through the body, all
// the more when the material yields.
inline constexpr float kFirmFill = 0.4f;

// Trilinear weights of a place in the cell, 0 to 1 or a little outside, in steps of 2^-23, so that
// as floats they still sum to exactly one.
inline std::array<float, 8> carrier_weights(const Vec3& local) {
    constexpr double kOne = 1 << 23;
    std::array<double, 8> weight;
    double sum = 0;
    int largest = 0;
    for (int c = 0; c < 8; ++c) {
        double w = 1;
        for (int d = 0; d < 3; ++d) w *= c >> d & 1 ? local[d] : 1 - local[d];
        weight[c] = std::round(w * kOne);
        sum += weight[c];
        if (weight[c] > weight[largest]) largest = c;
    }
    weight[largest] += kOne - sum;
    std::array<float, 8> result;
    for (int c = 0; c < 8; ++c) result[c] = static_cast<float>(weight[c] / kOne);
    return result;
}

}  // namespace swage
