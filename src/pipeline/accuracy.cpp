// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/accuracy.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

// `swage verify oblique-bar oblique-rod`: bending 5.62 % at 4 cells and 1.35 % at 8 (the rod), torsion
// 6.82 % and 1.93 % (the bar); both fall with the square.
constexpr double kBending = 0.9, kTorsion = 1.24;

}  // namespace

Accuracy accuracy_at(double cells) {
    const double square = cells * cells;
    return {kBending / square, kTorsion / square,
            static_cast<int>(std::ceil(std::sqrt(std::max(kBending, kTorsion) / 0.01)))};
}

}  // namespace swage
