// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/contact_sheet.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/srgb.h"

namespace swage {

namespace {

constexpr int kCodes = 16384;  // fine enough that decoding and encoding again is the identity

std::array<float, 256> make_decoder() {
    std::array<float, 256> table;
    for (int i = 0; i < 256; ++i) {
        table[static_cast<std::size_t>(i)] = static_cast<float>(linear_from_srgb(i / 255.0));
    }
    return table;
}

// Indexed by the square root of the light, which spreads the dark end as the eye does.
std::array<std::uint8_t, kCodes + 1> make_encoder() {
    std::array<std::uint8_t, kCodes + 1> table;
    for (int i = 0; i <= kCodes; ++i) {
        const double root = static_cast<double>(i) / kCodes;
        table[static_cast<std::size_t>(i)] =
            static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(root * root)));
    }
    return table;
}

// The old pixels [first, first + share.size()) under one new pixel, and how much of each.
struct Span {
    int first;
    std::vector<float> share;
};

std::vector<Span> spans(int from, int to) {
    std::vector<Span> result(static_cast<std::size_t>(to));
    const double step = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i) {
        const double low = i * step, high = (i + 1) * step;
        Span& span = result[static_cast<std::size_t>(i)];
        span.first = std::min(from - 1, static_cast<int>(low));
        const int last =
            std::clamp(static_cast<int>(std::ceil(high - 1e-9)) - 1, span.first, from - 1);
        for (int k = span.first; k <= last; ++k) {
            const double covered = std::min<double>(k + 1, high) - std::max<double>(k, low);
            span.share.push_back(static_cast<float>(std::max(0.0, covered) / step));
        }
    }
    return result;
}

}  // namespace

Image scaled(const Image& image, int width, int height) {
    static const auto decode = make_decoder();
    static const auto encode = make_encoder();
    width = std::max(1, width);
    height = std::max(1, height);
    const std::vector<Span> across = spans(image.width, width), down = spans(image.height, height);
    Image out{width, height, {}};
    out.rgb.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (const Span& row : down) {
        for (const Span& column : across) {
            std::array<float, 3> sum = {0, 0, 0};
            for (std::size_t j = 0; j < row.share.size(); ++j) {
                for (std::size_t i = 0; i < column.share.size(); ++i) {
                    const std::uint8_t* p = image.pixel(column.first + static_cast<int>(i),
                                                        row.first + static_cast<int>(j));
                    const float share = row.share[j] * column.share[i];
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += share * decode[p[c]];
                }
            }
            for (const float light : sum) {
                const float root = std::sqrt(std::clamp(light, 0.0f, 1.0f));
                out.rgb.push_back(encode[static_cast<std::size_t>(root * kCodes + 0.5f)]);
            }
        }
    }
    return out;
}

Image thumbnail(const Image& image, int largest_width, int largest_height) {
    const double scale = std::min(static_cast<double>(largest_width) / image.width,
                                  static_cast<double>(largest_height) / image.height);
    if (scale >= 1) return image;
    return scaled(image, static_cast<int>(std::lround(scale * image.width)),
                  static_cast<int>(std::lround(scale * image.height)));
}

Image contact_sheet(const std::vector<Image>& thumbnails, int columns, const SheetStyle& style) {
    if (thumbnails.empty()) fail(ExitCode::output, "a contact sheet needs at least one picture");
    const int count = static_cast<int>(thumbnails.size());
    columns = std::clamp(columns, 1, count);
    const int rows = (count + columns - 1) / columns;
    int cell_width = 0, cell_height = 0;
    for (const Image& t : thumbnails) {
        cell_width = std::max(cell_width, t.width);
        cell_height = std::max(cell_height, t.height);
    }
    Image sheet{columns * (cell_width + style.gap) + style.gap,
                rows * (cell_height + style.gap) + style.gap,
                {}};
    const std::size_t stride = 3 * static_cast<std::size_t>(sheet.width);
    sheet.rgb.resize(stride * static_cast<std::size_t>(sheet.height));
    for (std::size_t i = 0; i < sheet.rgb.size(); ++i) sheet.rgb[i] = style.paper[i % 3];
    for (int n = 0; n < count; ++n) {
        const Image& t = thumbnails[static_cast<std::size_t>(n)];
        const int left =
            style.gap + n % columns * (cell_width + style.gap) + (cell_width - t.width) / 2;
        const int top =
            style.gap + n / columns * (cell_height + style.gap) + (cell_height - t.height) / 2;
        for (int y = 0; y < t.height; ++y) {
            std::copy_n(
                t.pixel(0, y), 3 * t.width,
                sheet.rgb.begin() +
                    static_cast<std::ptrdiff_t>(static_cast<std::size_t>(top + y) * stride) +
                    3 * left);
        }
    }
    return sheet;
}

}  // namespace swage
