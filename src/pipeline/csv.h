// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of the comma separated tables.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace swage {

// What is not known stays empty: every reader of tables takes that for a gap.
inline std::string csv_number(double value) {
    return std::isnan(value) ? std::string() : fmt::format("{:.9g}", value);
}

// A name: quoted when it holds a comma or a quote.
inline std::string csv_text_cell(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace swage
