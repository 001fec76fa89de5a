// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as colours: viridis, whose steps look even, also in grey and to the colour-blind.
//
// Source: S. van der Walt, N. Smith, "viridis", matplotlib 1.5, 2015 (CC0): every tenth of it, and
// straight lines in sRGB between, which is off by no more than 2 of 255.
#pragma once

#include <array>

#include "render/image.h"

namespace swage {

// sRGB, each 0 to 255; `share` 0 to 1, beyond that the end.
std::array<double, 3> mapped_color(double share);

// The map as a picture from left to right, of which the ends take kMapEnd on either side, so that
// what is blurred or repeated there stays what it is.
inline constexpr double kMapEnd = 0.25;
Image color_strip();

}  // namespace swage
