// SPDX-License-Identifier: GPL-3.0-or-later
// OpenEXR files of 32-bit or 16-bit floats, which compositors take.
#pragma once

#include <string>
#include <vector>

namespace swage {

struct ExrChannel {
    std::string name;          // "layer.channel", up to 31 letters
    std::vector<float> value;  // width * height, rows from the top
    bool half = false;         // 16 bits
};

// One picture of these channels, none of which has another's name. Throws Error(output).
std::string encode_exr(int width, int height, const std::vector<ExrChannel>& channels);

}  // namespace swage
