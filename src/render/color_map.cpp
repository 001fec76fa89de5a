// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace swage {

namespace {

constexpr std::array<std::array<int, 3>, 11> kViridis = {{{0x44, 0x01, 0x54},
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

std::array<double, 3> mapped_color(double share) {
    const double at = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
    std::array<double, 3> color;
    for (std::size_t c = 0; c < 3; ++c) {
        color[c] =
            kViridis[low][c] + (at - double(low)) * (kViridis[low + 1][c] - kViridis[low][c]);
    }
    return color;
}

Image color_strip() {
    Image strip{kStripWidth, kStripHeight, {}};
    for (int y = 0; y < kStripHeight; ++y) {
        for (int x = 0; x < kStripWidth; ++x) {
            const double at = (x + 0.5) / kStripWidth;
            for (const double c : mapped_color((at - kMapEnd) / (1 - 2 * kMapEnd))) {
                strip.rgb.push_back(static_cast<std::uint8_t>(std::lround(c)));
            }
        }
    }
    return strip;
}

}  // namespace swage
