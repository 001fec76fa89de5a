// SPDX-License-Identifier: GPL-3.0-or-later
// A picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace swage {

struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // 3 * width * height, rows from the top, sRGB encoded
    // width * height, by which rgb is not multiplied; empty: 255
    std::vector<std::uint8_t> alpha = {};

    const std::uint8_t* pixel(int x, int y) const {
        return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x))];
    }
};

}  // namespace swage
