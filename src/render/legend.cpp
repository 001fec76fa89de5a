// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/color_map.h"
#include "render/letters.h"

namespace swage {

namespace {

constexpr double kPictureRows = 330;  // of a picture, to each unit of the legend; one is a pixel
constexpr double kShade = 0.45;       // of the picture, left under the legend
using Color = std::array<double, 3>;
constexpr Color kInk = {238, 238, 238}, kGround = {24, 26, 30};

std::uint8_t rounded(double value) { return static_cast<std::uint8_t>(std::lround(value)); }

// Colours over what is there, of which `share` may let something through.
struct Paint {
    Image& image;

    void fill(int x0, int y0, int x1, int y1, const Color& color, double share = 1) {
        for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y) {
            for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x) {
                const std::size_t pixel = static_cast<std::size_t>(y) * image.width + x;
                const double below =
                    (1 - share) * (image.alpha.empty() ? 1 : image.alpha[pixel] / 255.0);
                if (!image.alpha.empty()) image.alpha[pixel] = rounded(255 * (share + below));
                for (std::size_t c = 0; c < 3; ++c) {
                    std::uint8_t& value = image.rgb[3 * pixel + c];
                    value = rounded((share * color[c] + below * value) / (share + below));
                }
            }
        }
    }
};

// [pixel]
struct LegendSize {
    double letters;            // size of these
    int pad, line, bar, tick;  // line: from one base line to the next
    int mark;                  // how wide ticks are

    int height() const { return pad + 2 * line + bar + 2 * tick; }
    int arrow() const { return bar; }  // how long an end of the bar is
};
LegendSize size_in(int picture_height) {
    const double unit = std::max(1.0, picture_height / kPictureRows);
    const auto pixels = [&](double units) { return static_cast<int>(std::lround(units * unit)); };
    return {10 * unit, pixels(5), pixels(12), pixels(8), pixels(2), std::max(1, pixels(0.8))};
}

// From x on, in a line whose top is y.
void write(Paint& paint, double x, int y, const LegendSize& size, const std::string& text) {
    const double base = y + std::round(kLetterHeight * size.letters);
    for (const LetterPixels& letter : letters_of(text, x, base, size.letters)) {
        for (int row = 0; row < letter.height; ++row) {
            for (int column = 0; column < letter.width; ++column) {
                const std::size_t n = std::size_t(row) * std::size_t(letter.width) + column;
                if (letter.cover[n] == 0) continue;
                const int px = letter.left + column, py = letter.top + row;
                paint.fill(px, py, px + 1, py + 1, kInk, letter.cover[n] / 255.0);
            }
        }
    }
}

// A triangle beside the bar, from x on to `tip`, which lies on either side.
void draw_arrow(Paint& paint, int x, int tip, int y, int height, const Color& color) {
    const double middle = y + 0.5 * height;
    for (int column = std::min(x, tip); column < std::max(x, tip); ++column) {
        const double reach = 0.5 * height * (column + 0.5 - tip) / (x - tip);
        for (int row = y; row < y + height; ++row) {
            const double low = std::max<double>(row, middle - reach);
            const double high = std::min<double>(row + 1, middle + reach);
            if (high > low) paint.fill(column, row, column + 1, row + 1, color, high - low);
        }
    }
}

// Ten to that, exactly as far as numbers go.
double power_of_ten(int exponent) {
    double power = 1;
    for (int n = 0; n < std::abs(exponent); ++n) power *= 10;
    return exponent < 0 ? 1 / power : power;
}

int exponent_of(double value) {
    int exponent = 0;
    while (power_of_ten(exponent + 1) <= value && exponent < 300) ++exponent;
    while (power_of_ten(exponent) > value && exponent > -300) --exponent;
    return exponent;
}

// With so many decimals, and no minus before nothing.
std::string decimal(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, std::clamp(decimals, 0, 12));
    const bool is_nothing = text.find_first_not_of("-0.") == std::string::npos;
    return is_nothing && text.front() == '-' ? text.substr(1) : text;
}

struct Prefix {
    const char* name;
    int exponent;
};
Prefix prefix_of(double most) {
    constexpr Prefix kPrefix[] = {{"G", 9}, {"M", 6}, {"k", 3}, {"", 0}, {"m", -3}};
    for (const Prefix& one : kPrefix) {
        if (most >= power_of_ten(one.exponent)) return one;
    }
    return {"", 0};
}

}  // namespace

Legend make_legend(const std::string& title, const std::string& unit, double low, double high) {
    Legend legend{title, {}};
    const double most = std::max(std::abs(low), std::abs(high));
    if (!unit.empty()) {
        const Prefix prefix = prefix_of(most);
        legend.title += fmt::format(" [{}{}]", prefix.name, unit);
        low /= power_of_ten(prefix.exponent);
        high /= power_of_ten(prefix.exponent);
    }
    const double span = high - low;
    if (!(span > 0)) return legend;
    int exponent = exponent_of(span / 5);
    double step = power_of_ten(exponent);
    for (const int times : {2, 5, 10}) {
        if (span / step <= 7) break;
        step = times * power_of_ten(exponent);
    }
    if (step >= power_of_ten(exponent + 1)) ++exponent;
    constexpr double kRoom = 0.1;  // of the bar, that a number takes
    const auto first = static_cast<long>(std::ceil(low / step - 1e-9));
    const auto last = static_cast<long>(std::floor(high / step + 1e-9));
    for (long n = first; n <= last && n - first < 20; ++n) {
        const double share = (static_cast<double>(n) * step - low) / span;
        const bool at_end = std::min(share, 1 - share) < 1e-9;
        if (!at_end && (share < kRoom || share > 1 - kRoom)) continue;
        legend.tick.push_back({share, decimal(static_cast<double>(n) * step, -exponent)});
    }
    // Ends that are not round, to three digits of the span.
    const int decimals = std::max(-exponent, 2 - exponent_of(span));
    if (legend.tick.empty() || legend.tick.front().share > 1e-9) {
        legend.tick.insert(legend.tick.begin(), {0, decimal(low, decimals)});
    }
    if (legend.tick.back().share < 1 - 1e-9) legend.tick.push_back({1, decimal(high, decimals)});
    return legend;
}

double legend_share(int picture_height) {
    const LegendSize size = size_in(picture_height);
    const int rows = size.height() + size.pad;
    return 2 * rows > picture_height ? 0 : double(rows) / picture_height;
}

bool draw_legend(const Legend& legend, Image& image) {
    const LegendSize size = size_in(image.height);
    const int pad = size.pad, bar = size.bar;
    const auto width_of = [&](const std::string& text) {
        return static_cast<int>(std::ceil(letters_width(text, size.letters)));
    };
    int ends = legend.below || legend.above ? size.arrow() : 0;  // what stands out beside the bar
    for (const Legend::Tick& one : legend.tick) ends = std::max(ends, width_of(one.text) / 2);
    const int length = std::max(image.width * 2 / 5, width_of(legend.title));
    const int left = (image.width - length) / 2, right = left + length;
    const int top = image.height - size.height() - pad;
    if (left < ends + 2 * pad || top < image.height / 2) return false;

    Paint paint{image};
    paint.fill(left - ends - pad, top, right + ends + pad, top + size.height(), kGround,
               1 - kShade);
    write(paint, left, top + pad, size, legend.title);
    const int y = top + pad + size.line;
    for (int x = 0; x < length; ++x) {
        paint.fill(left + x, y, left + x + 1, y + bar,
                   mapped_color(legend.scale, (x + 0.5) / length));
    }
    if (legend.below) {
        draw_arrow(paint, left, left - size.arrow(), y, bar, mapped_color(legend.scale, 0));
    }
    if (legend.above) {
        draw_arrow(paint, right, right + size.arrow(), y, bar, mapped_color(legend.scale, 1));
    }
    const auto at = [&](const Legend::Tick& one) {
        return left + static_cast<int>(std::lround(one.share * (length - size.mark)));
    };
    const auto begin_of = [&](const Legend::Tick& one) {
        return at(one) + 0.5 * (size.mark - letters_width(one.text, size.letters));
    };
    if (legend.tick.empty()) return true;
    const double last = begin_of(legend.tick.back());
    double written = 0;  // up to there
    for (const Legend::Tick& one : legend.tick) {
        const double from = begin_of(one), to = from + width_of(one.text) + pad;
        if (from < written || (to > last && from < last)) continue;  // the end has its number
        paint.fill(at(one), y + bar, at(one) + size.mark, y + bar + size.tick, kInk);
        write(paint, from, y + bar + 2 * size.tick, size, one.text);
        written = to;
    }
    return true;
}

}  // namespace swage
