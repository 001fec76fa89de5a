// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swage {

namespace {

using Map = std::array<std::array<int, 3>, 11>;
constexpr Map kBlueRed = {{{0x05, 0x30, 0x61},
                           {0x21, 0x66, 0xac},
                           {0x43, 0x93, 0xc3},
                           {0x92, 0xc5, 0xde},
                           {0xd1, 0xe5, 0xf0},
                           {0xf7, 0xf7, 0xf7},
                           {0xfd, 0xdb, 0xc7},
                           {0xf4, 0xa5, 0x82},
                           {0xd6, 0x60, 0x4d},
                           {0xb2, 0x18, 0x2b},
                           {0x67, 0x00, 0x1f}}};
constexpr Map kViridis = {{{0x44, 0x01, 0x54},
                           {0x48, 0x25, 0x76},
                           {0x41, 0x44, 0x87},
                           {0x35, 0x60, 0x8d},
                           {0x2a, 0x78, 0x8e},
                           {0x21, 0x90, 0x8c},
                           {0x22, 0xa8, 0x84},
                           {0x43, 0xbf, 0x71},
                           {0x7a, 0xd1, 0x51},
                           {0xbb, 0xdf, 0x27},
                           {0xfd, 0xe7, 0x25}}};
constexpr int kStripWidth = 1024, kStripHeight = 4;

}  // namespace

ColorScale color_scale(double low, double high, bool is_signed) {
    if (!is_signed || !(low < 0 && high > 0)) return {};
    const double most = std::max(-low, high);
    return {true, 0.5 + 0.5 * low / most, 0.5 + 0.5 * high / most};
}

std::array<double, 3> mapped_color(const ColorScale& scale, double share) {
    const Map& map = scale.diverges ? kBlueRed : kViridis;
    const double of_map = scale.first + std::clamp(share, 0.0, 1.0) * (scale.last - scale.first);
    const double at = of_map * (map.size() - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(at), map.size() - 2);
    std::array<double, 3> color;
    for (std::size_t c = 0; c < 3; ++c) {
        color[c] = map[low][c] + (at - double(low)) * (map[low + 1][c] - map[low][c]);
    }
    return color;
}

Image color_strip(const ColorScale& scale) {
    Image strip{kStripWidth, kStripHeight, {}};
    for (int y = 0; y < kStripHeight; ++y) {
        for (int x = 0; x < kStripWidth; ++x) {
            const double at = (x + 0.5) / kStripWidth;
            for (const double c : mapped_color(scale, (at - kMapEnd) / (1 - 2 * kMapEnd))) {
                strip.rgb.push_back(static_cast<std::uint8_t>(std::lround(c)));
            }
        }
    }
    return strip;
}

}  // namespace swage
