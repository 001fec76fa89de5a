// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as colours: viridis, whose steps look even, also in grey and to the colour-blind; of what
// lies on both sides of zero blue for less, red for more, and white for nothing.
//
// Sources: S. van der Walt, N. Smith, "viridis", matplotlib 1.5, 2015 (CC0): every tenth of it, and
// straight lines in sRGB between, which is off by no more than 2 of 255. C. Brewer, "RdBu" of
// eleven classes, ColorBrewer 2.0, 2013, its classes taken as points with straight lines between.
#pragma once

#include <array>

#include "render/image.h"

namespace swage {

struct ColorScale {
    bool diverges = false;       // blue and red
    double first = 0, last = 1;  // of the whole map, what the scale's ends have
};
// From one number to another that is more. `is_signed`: zero means nothing, and is the middle of
// the map where it lies between them, from which both sides go on alike.
ColorScale color_scale(double low, double high, bool is_signed);

// sRGB, each 0 to 255; `share` of the scale, 0 to 1, beyond that the end.
std::array<double, 3> mapped_color(const ColorScale& scale, double share);

// The scale as a picture from left to right, of which the ends take kMapEnd on either side, so that
// what is blurred or repeated there stays what it is.
inline constexpr double kMapEnd = 0.25;
Image color_strip(const ColorScale& scale);

}  // namespace swage
