// SPDX-License-Identifier: GPL-3.0-or-later
// After R. von Mises, of xx, yy, zz, xy, yz, zx.
#pragma once

#include <array>
#include <cmath>

namespace swage::test {

inline double equivalent(const std::array<double, 6>& s) {
    const double mean = (s[0] + s[1] + s[2]) / 3;
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += (s[i] - mean) * (s[i] - mean) + 2 * s[i + 3] * s[i + 3];
    return std::sqrt(1.5 * sum);
}

}  // namespace swage::test
