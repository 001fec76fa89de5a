// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/plot_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swage {

namespace {
constexpr double kWidth = 300, kHeight = 220, kLeft = 52, kBottom = 34, kTop = 26, kRight = 12;

std::string svg_head(const std::string& title, const std::string& more) {
    return fmt::format(
        "<svg viewBox='0 0 {} {}' role='img' aria-label='{}'><text x='8' y='16' "
        "class='t'>{}{}</text>",
        kWidth, kHeight, escaped(title), escaped(title), more);
}

// Powers of ten up the left side.
struct Decades {
    double floor, ceiling;  // logarithms

    Decades(double low, double high)
        : floor(std::floor(std::log10(low))), ceiling(std::ceil(std::log10(high) + 1e-9)) {}
    double y_at(double value) const {
        const double share = (std::log10(std::max(value, 1e-16)) - floor) / (ceiling - floor);
        return kHeight - kBottom - (kHeight - kBottom - kTop) * share;
    }
    std::string svg() const {
        std::string lines;
        for (double decade = floor; decade <= ceiling; ++decade) {
            const double y = y_at(std::pow(10, decade));
            lines += fmt::format(
                "<path d='M{} {:.1f}H{}' class='g'/><text x='{}' y='{:.1f}' "
                "class='n'>1e{:.0f}</text>",
                kLeft, y, kWidth - kRight, kLeft - 6, y + 4, decade);
        }
        return lines;
    }
};

std::string svg_foot(const std::string& abscissa) {
    return fmt::format("<text x='{}' y='{}' class='m'>{}</text></svg>\n", (kLeft + kWidth) / 2,
                       kHeight - 3, escaped(abscissa));
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string out;
    for (char c : text) {
        out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return out;
}

std::string series_svg(const std::string& title, const Series& series) {
    double low = 1e300, high = 0;
    for (const Value& v : series.value) {
        const double error = std::max(v.error, 1e-16);
        low = std::min({low, error, v.bound});
        high = std::max({high, error, v.bound});
    }
    const double first = series.value.front().across / 1.25,
                 last = 1.25 * series.value.back().across;
    const Decades decades(low, high);
    const auto x_at = [&](double across) {
        return kLeft +
               (kWidth - kLeft - kRight) * std::log(across / first) / std::log(last / first);
    };
    std::string svg = svg_head(title, ", order " + order_text(series)) + decades.svg();
    std::string line, bound;
    for (const Value& v : series.value) {
        const char* act = line.empty() ? "M" : "L";
        line += fmt::format("{}{:.1f} {:.1f}", act, x_at(v.across), decades.y_at(v.error));
        bound += fmt::format("{}{:.1f} {:.1f}", act, x_at(v.across), decades.y_at(v.bound));
        svg += fmt::format("<text x='{:.1f}' y='{}' class='m'>{}</text>", x_at(v.across),
                           kHeight - 16, v.across);
    }
    svg += fmt::format("<path d='{}' class='b'/><path d='{}' class='e'/>", bound, line);
    for (const Value& v : series.value) {
        svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3'/>", x_at(v.across),
                           decades.y_at(v.error));
    }
    return svg + svg_foot("cells across");
}

std::string plot_svg(const Plot& plot) {
    double low = 1e300, high = 0, first = 1e300, last = -1e300;
    for (const Plot::Line& line : plot.line) {
        for (const auto& [x, y] : line.point) {
            low = std::min(low, y), high = std::max(high, y);
            first = std::min(first, x), last = std::max(last, x);
        }
    }
    if (!(high > 0) || !(last > first)) return {};
    const Decades decades(low, high);
    const auto x_at = [&](double x) {
        return kLeft + (kWidth - kLeft - kRight) * (x - first) / (last - first);
    };
    std::string svg = svg_head(plot.title, ": " + escaped(plot.ordinate)) + decades.svg();
    for (const Plot::Line& line : plot.line) {
        std::string path;
        for (const auto& [x, y] : line.point) {
            path +=
                fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_at(x), decades.y_at(y));
        }
        svg += fmt::format("<path d='{}' class='{}'><title>{}</title></path>", path,
                           line.dashed ? "b" : "e", escaped(line.name));
    }
    for (const double x : {first, last}) {
        svg += fmt::format("<text x='{:.1f}' y='{}' class='m'>{:.3g}</text>", x_at(x), kHeight - 16,
                           x);
    }
    return svg + svg_foot(plot.abscissa);
}

}  // namespace swage
