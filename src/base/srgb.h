// SPDX-License-Identifier: GPL-3.0-or-later
// The transfer curve of IEC 61966-2-1 between light and the bytes of a picture.
#pragma once

#include "base/portable_math.h"

namespace swage {

inline double linear_from_srgb(double s) {
    return s <= 0.04045 ? s / 12.92 : portable::pow((s + 0.055) / 1.055, 2.4);
}
inline double srgb_from_linear(double l) {
    return l <= 0.0031308 ? 12.92 * l : 1.055 * portable::pow(l, 1 / 2.4) - 0.055;
}

}  // namespace swage
