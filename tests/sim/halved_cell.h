// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "matter/aggregate.h"

namespace swage::test {

// Half the body's own material, above, and half its first inset's.
inline MixedCell halved_cell(CellId cell) {
    return {.cell = cell,
            .material = {0, 1},
            .fill = {0.5f, 0.5f},
            .centroid = {Eigen::Vector3f(0, 0.25f, 0), Eigen::Vector3f(0, -0.25f, 0)},
            .normal = Eigen::Vector3f::UnitY()};
}

// What of a whole cell lies beyond a plane, of the body's own material, and what does not.
inline MixedCell divided_cell(CellId cell, const Vec3& normal, double at) {
    constexpr int kAcross = 20;
    std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
    std::array<int, 2> count{};
    for (int n = 0; n < kAcross * kAcross * kAcross; ++n) {
        const Vec3i site(n % kAcross, n / kAcross % kAcross, n / kAcross / kAcross);
        const Vec3 place =
            (site.cast<double>() + Vec3::Constant(0.5)) / kAcross - Vec3::Constant(0.5);
        const bool beyond = place.dot(normal) > at;
        sum[!beyond] += place;
        ++count[!beyond];
    }
    MixedCell mixed{.cell = cell,
                    .material = {0, 1},
                    .fill = {},
                    .centroid = {},
                    .normal = normal.cast<float>()};
    for (int p = 0; p < 2; ++p) {
        mixed.fill[p] = static_cast<float>(count[p]) / (kAcross * kAcross * kAcross);
        mixed.centroid[p] = (sum[p] / std::max(1, count[p])).cast<float>();
    }
    return mixed;
}

}  // namespace swage::test
