// SPDX-License-Identifier: GPL-3.0-or-later
// After "OpenEXR File Layout" (openexr.com): one part of scan lines, packed by ZIP, sixteen at a
// time: bytes of even and odd places apart, each as its difference from the one before.
#include "render/exr.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/error.h"
#include "render/deflate.h"

namespace swage {

namespace {

constexpr int kBlockRows = 16;
constexpr char kZip = 3;

template <typename Whole>
void add(std::string& out, Whole value) {
    for (std::size_t byte = 0; byte < sizeof value; ++byte) {
        out += static_cast<char>(value >> (8 * byte) & 255);
    }
}
void add_float(std::string& out, float value) { add(out, std::bit_cast<std::uint32_t>(value)); }

void add_attribute(std::string& out, const char* name, const char* type, const std::string& value) {
    out += name;
    out += '\0';
    out += type;
    out += '\0';
    add(out, static_cast<std::uint32_t>(value.size()));
    out += value;
}

std::string header_of(int width, int height, const std::vector<ExrChannel>& channels) {
    std::string out, list, window, one, origin;
    add(out, std::uint32_t(20000630));
    add(out, std::uint32_t(2));
    for (const ExrChannel& channel : channels) {
        list += channel.name;
        list += '\0';
        add(list, std::uint32_t(2));  // floats
        list += std::string(4, '\0');
        add(list, std::uint32_t(1));
        add(list, std::uint32_t(1));
    }
    list += '\0';
    for (const int edge : {0, 0, width - 1, height - 1}) add(window, std::uint32_t(edge));
    add_float(one, 1);
    for (int k = 0; k < 2; ++k) add_float(origin, 0);
    add_attribute(out, "channels", "chlist", list);
    add_attribute(out, "compression", "compression", {kZip});
    add_attribute(out, "dataWindow", "box2i", window);
    add_attribute(out, "displayWindow", "box2i", window);
    add_attribute(out, "lineOrder", "lineOrder", std::string(1, '\0'));
    add_attribute(out, "pixelAspectRatio", "float", one);
    add_attribute(out, "screenWindowCenter", "v2f", origin);
    add_attribute(out, "screenWindowWidth", "float", one);
    out += '\0';
    return out;
}

std::string packed(const std::string& plain) {
    std::string apart;
    apart.reserve(plain.size());
    for (const std::size_t first : {0, 1}) {
        for (std::size_t i = first; i < plain.size(); i += 2) apart += plain[i];
    }
    for (std::size_t i = apart.size(); i-- > 1;) {
        apart[i] = static_cast<char>(apart[i] - apart[i - 1] + 128);
    }
    std::string packed = zlib_packed(apart);
    return packed.size() < plain.size() ? packed : plain;  // readers tell by the size
}

}  // namespace

std::string encode_exr(int width, int height, std::vector<ExrChannel> channels) {
    const std::size_t columns = static_cast<std::size_t>(width);
    if (width <= 0 || height <= 0) fail(ExitCode::output, "an empty picture");
    std::sort(channels.begin(), channels.end(),
              [](const ExrChannel& a, const ExrChannel& b) { return a.name < b.name; });
    std::string out = header_of(width, height, channels);
    std::string blocks;
    const int count = (height + kBlockRows - 1) / kBlockRows;
    const std::size_t first = out.size() + 8 * static_cast<std::size_t>(count);
    for (int top = 0; top < height; top += kBlockRows) {
        std::string plain;
        for (int y = top; y < std::min(height, top + kBlockRows); ++y) {
            for (const ExrChannel& channel : channels) {
                const float* row = channel.value.data() + columns * static_cast<std::size_t>(y);
                for (std::size_t x = 0; x < columns; ++x) add_float(plain, row[x]);
            }
        }
        add(out, static_cast<std::uint64_t>(first + blocks.size()));
        const std::string body = packed(plain);
        add(blocks, static_cast<std::uint32_t>(top));
        add(blocks, static_cast<std::uint32_t>(body.size()));
        blocks += body;
    }
    return out + blocks;
}

}  // namespace swage
