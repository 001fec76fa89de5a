// SPDX-License-Identifier: GPL-3.0-or-later
// What the colours of a picture mean: a bar of the colour map with numbers beside it.
#pragma once

#include <string>
#include <vector>

#include "render/color_map.h"
#include "render/image.h"

namespace swage {

struct Legend {
    struct Tick {
        double share;  // 0 to 1, along the bar
        std::string text;
    };
    std::string title;  // with its unit
    std::vector<Tick> tick;
    ColorScale scale = {};
    bool below = false,
         above = false;  // whether anything lies beyond an end, which is an arrow then
};

// With round numbers, and the ends of the range where these leave room. `unit` is SI ("Pa"), or
// empty; it gets the prefix that suits the range, low < high.
Legend make_legend(const std::string& title, const std::string& unit, double low, double high);

// At the bottom of the picture, on a darkened ground. A picture too small for it stays as it is:
// false then.
bool draw_legend(const Legend& legend, Image& image);
// The share of the picture's height that it takes at the bottom, up to half; 0: it is too
// small.
double legend_share(int picture_height);

}  // namespace swage
