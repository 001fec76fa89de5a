// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

namespace swage {

// What a number is without its decimals; of one beyond all int the nearest int, of none 0.
constexpr int to_int(double value) {
    constexpr int kLow = std::numeric_limits<int>::min(), kHigh = std::numeric_limits<int>::max();
    if (value >= kHigh) return kHigh;
    if (value <= kLow) return kLow;
    return value == value ? static_cast<int>(value) : 0;
}

}  // namespace swage
