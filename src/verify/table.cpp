// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace swage {

namespace {

// case, expected, got, error, bound, order, seconds, source, verdict
constexpr int kColumns = 9;
struct Row {
    std::array<std::string, kColumns> cell;
    bool missed = false;
};
const Row kHead = {{"CASE", "EXPECTED", "GOT", "ERROR", "BOUND", "ORDER", "SECONDS", "SOURCE", ""},
                   false};

std::string number_text(double x) { return fmt::format("{:.6g}", x); }
std::string error_text(double x) {
    return x >= 1e-5 || x == 0 ? fmt::format("{:.3g} %", 100 * x) : fmt::format("{:.1e}", x);
}

std::vector<Row> rows_of(const Verified& one) {
    const Case& c = one.verification;
    std::vector<Row> rows;
    for (const Value& v : one.result.value) {
        std::string name = c.name + ": " + v.what;
        if (v.across > 0) name += fmt::format(", {} cells", v.across);
        std::string order;
        bool low_order = false;
        for (const Series& series : one.result.series) {
            if (series.what != v.what || series.value.back().across != v.across) continue;
            order = fmt::format("{:.2f}", series.order);
            low_order = order_missed(c, series);
            if (c.least_order > 0) order += fmt::format(" (>= {:.1f})", c.least_order);
        }
        const bool missed = v.missed() || low_order;
        rows.push_back({{name, number_text(v.expected), number_text(v.got), error_text(v.error),
                         v.bounded() ? error_text(v.bound) : "-", order,
                         fmt::format("{:.2f}", v.seconds), c.source, missed ? "MISSED" : ""},
                        missed});
    }
    if (!one.result.failure.empty()) {
        rows.push_back({{c.name + ": " + one.result.failure, "", "", "", "", "",
                         fmt::format("{:.2f}", one.result.seconds), c.source, "MISSED"},
                        true});
    }
    return rows;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (char c : text) {
        out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return out;
}

// Error against cells across, both logarithmic; dashed: the bounds.
std::string plot_svg(const std::string& title, const Series& series) {
    constexpr double kWidth = 300, kHeight = 220, kLeft = 52, kBottom = 34, kTop = 26, kRight = 12;
    double low = 1e300, high = 0;
    for (const Value& v : series.value) {
        const double error = std::max(v.error, 1e-16);
        low = std::min({low, error, v.bound});
        high = std::max({high, error, v.bound});
    }
    const double first = series.value.front().across / 1.25,
                 last = 1.25 * series.value.back().across;
    const double floor = std::floor(std::log10(low)), ceiling = std::ceil(std::log10(high) + 1e-9);
    const auto x_at = [&](double across) {
        return kLeft +
               (kWidth - kLeft - kRight) * std::log(across / first) / std::log(last / first);
    };
    const auto y_at = [&](double error) {
        const double share = (std::log10(std::max(error, 1e-16)) - floor) / (ceiling - floor);
        return kHeight - kBottom - (kHeight - kBottom - kTop) * share;
    };
    std::string svg = fmt::format("<svg viewBox='0 0 {} {}' role='img' aria-label='{}'>", kWidth,
                                  kHeight, escaped(title));
    svg += fmt::format("<text x='{}' y='16' class='t'>{}, order {:.2f}</text>", 8, escaped(title),
                       series.order);
    for (double decade = floor; decade <= ceiling; ++decade) {
        const double y = y_at(std::pow(10, decade));
        svg += fmt::format(
            "<path d='M{} {:.1f}H{}' class='g'/><text x='{}' y='{:.1f}' class='n'>1e{:.0f}</text>",
            kLeft, y, kWidth - kRight, kLeft - 6, y + 4, decade);
    }
    std::string line, bound;
    for (const Value& v : series.value) {
        const char* act = line.empty() ? "M" : "L";
        line += fmt::format("{}{:.1f} {:.1f}", act, x_at(v.across), y_at(v.error));
        bound += fmt::format("{}{:.1f} {:.1f}", act, x_at(v.across), y_at(v.bound));
        svg += fmt::format("<text x='{:.1f}' y='{}' class='m'>{}</text>", x_at(v.across),
                           kHeight - 16, v.across);
    }
    svg += fmt::format("<path d='{}' class='b'/><path d='{}' class='e'/>", bound, line);
    for (const Value& v : series.value) {
        svg +=
            fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3'/>", x_at(v.across), y_at(v.error));
    }
    return svg + fmt::format("<text x='{}' y='{}' class='m'>cells across</text></svg>\n",
                             (kLeft + kWidth) / 2, kHeight - 3);
}

constexpr const char* kPageHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>swage verify</title><style>
body{font:14px system-ui,sans-serif;margin:2rem;color:#222;background:#fff}
table{border-collapse:collapse}td,th{padding:.2rem .7rem;text-align:right;border-bottom:1px solid #ddd}
td:first-child,th:first-child,td:nth-child(8),th:nth-child(8){text-align:left}
.missed td{background:#fde0dc}div{display:flex;flex-wrap:wrap;gap:1rem}svg{width:320px}
.t{font-size:12px;font-weight:600}.n{font-size:10px;text-anchor:end}.m{font-size:10px;text-anchor:middle}
.g{stroke:#e4e4e4}.e{stroke:#1f5f99;fill:none;stroke-width:1.6}
.b{stroke:#b3541e;fill:none;stroke-dasharray:4 3}circle{fill:#1f5f99}
</style></head><body><h1>swage verify</h1>
)";

}  // namespace

std::string verified_text(const std::vector<Verified>& all) {
    std::vector<Row> rows = {kHead};
    int missed = 0;
    for (const Verified& one : all) {
        missed += one.result.missed;
        for (Row& row : rows_of(one)) rows.push_back(std::move(row));
    }
    std::array<std::size_t, kColumns> width{};
    for (const Row& row : rows) {
        if (row.cell[1].empty()) continue;  // a sentence
        for (int c = 0; c < kColumns; ++c) width[c] = std::max(width[c], row.cell[c].size());
    }
    std::string text;
    for (const Row& row : rows) {
        std::string line;
        for (int c = 0; c < kColumns; ++c) {
            const bool left = c == 0 || c >= 7;
            line += left ? fmt::format("{:<{}}  ", row.cell[c], width[c])
                         : fmt::format("{:>{}}  ", row.cell[c], width[c]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text +
           fmt::format("{} of {} cases within their bounds\n", all.size() - missed, all.size());
}

std::string verified_markdown(const std::vector<Verified>& all) {
    std::string text =
        "| case | | cells across: error (bound) | expected after |\n|---|---|---|---|\n";
    for (const Verified& one : all) {
        // In the order in which the resolutions come.
        std::vector<const Value*> worst;
        for (const Value& v : one.result.value) {
            if (!v.bounded()) continue;
            const auto same = std::find_if(worst.begin(), worst.end(), [&](const Value* other) {
                return other->across == v.across;
            });
            if (same == worst.end()) {
                worst.push_back(&v);
            } else if (!(v.error / v.bound <= (*same)->error / (*same)->bound)) {
                *same = &v;
            }
        }
        std::string errors;
        for (const Value* v : worst) {
            errors += errors.empty() ? "" : ", ";
            if (v->across > 0) errors += fmt::format("{}: ", v->across);
            const std::string error = error_text(v->error);
            errors += fmt::format("{} ({})", v->missed() ? "**" + error + "**" : error,
                                  error_text(v->bound));
        }
        if (!one.result.failure.empty()) errors = "**" + one.result.failure + "**";
        text += fmt::format("| `{}` | {} | {} | {} |\n", one.verification.name,
                            one.verification.help, errors, one.verification.source);
    }
    return text;
}

std::string verified_page(const std::vector<Verified>& all) {
    std::string page = kPageHead;
    const auto add_row = [&](const Row& row, const char* tag) {
        page += row.missed ? "<tr class='missed'>" : "<tr>";
        for (const std::string& cell : row.cell) {
            page += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
        }
        page += "</tr>\n";
    };
    page += "<table>\n";
    add_row(kHead, "th");
    for (const Verified& one : all) {
        for (const Row& row : rows_of(one)) add_row(row, "td");
    }
    page += "</table>\n<h2>Error against cells across (dashed: bound)</h2>\n<div>\n";
    for (const Verified& one : all) {
        for (const Series& series : one.result.series) {
            page += plot_svg(one.verification.name + ": " + series.what, series);
        }
    }
    return page + "</div></body></html>\n";
}

}  // namespace swage
