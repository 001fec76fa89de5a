// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "verify/plot_svg.h"

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
// Of an error or a bound.
std::string error_text(double x, const std::string& unit) {
    const bool is_share = unit == "%", is_small = x < 1e-5 && x != 0;
    if (is_small && is_share) return fmt::format("{:.1e}", x);
    const std::string number =
        is_small ? fmt::format("{:.1e}", x) : fmt::format("{:.3g}", is_share ? 100 * x : x);
    return unit.empty() ? number : number + " " + unit;
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
            order = order_text(series);
            low_order = order_missed(c, series);
            if (c.least_order > 0) order += fmt::format(" (>= {:.1f})", c.least_order);
        }
        const bool missed = v.missed() || low_order;
        rows.push_back(
            {{name, number_text(v.expected), number_text(v.got), error_text(v.error, v.unit),
              v.bounded() ? error_text(v.bound, v.unit) : "-", order,
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

constexpr const char* kPageHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>swage verify</title><style>
body{font:14px system-ui,sans-serif;margin:2rem;color:#222;background:#fff}
table{border-collapse:collapse}
td,th{padding:.2rem .7rem;text-align:right;border-bottom:1px solid #ddd}
td:first-child,th:first-child,td:nth-child(8),th:nth-child(8){text-align:left}
.missed td{background:#fde0dc}div{display:flex;flex-wrap:wrap;gap:1rem}svg{width:320px}
.t{font-size:12px;font-weight:600}.n{font-size:10px;text-anchor:end}
.m{font-size:10px;text-anchor:middle}
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
            const std::string error = error_text(v->error, v->unit);
            errors += fmt::format("{} ({})", v->missed() ? "**" + error + "**" : error,
                                  error_text(v->bound, v->unit));
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
            page += series_svg(one.verification.name + ": " + series.what, series);
        }
    }
    page += "</div>\n<h2>What happened (logarithmic)</h2>\n<div>\n";
    for (const Verified& one : all) {
        for (const Plot& plot : one.result.plot) page += plot_svg(plot);
    }
    return page + "</div></body></html>\n";
}

}  // namespace swage
