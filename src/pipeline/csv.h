// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of the comma separated tables, and the columns of energies that they share.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "sim/advance.h"

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

struct EnergyColumn {
    const char* name;
    double Books::*value;
};
inline constexpr std::array<EnergyColumn, 14> kEnergyColumns{{
    {"kinetic energy [J]", &Books::kinetic},
    {"elastic energy [J]", &Books::elastic},
    {"contact energy [J]", &Books::contact},
    {"plastic work [J]", &Books::plastic},
    {"damped work [J]", &Books::damped},
    {"friction work [J]", &Books::friction},
    {"drag work [J]", &Books::drag},
    {"machine work [J]", &Books::work},
    {"load work [J]", &Books::load_work},
    {"gravity work [J]", &Books::gravity_work},
    {"severed energy [J]", &Books::severed_energy},
    {"fracture energy [J]", &Books::fracture},
    {"set free [J]", &Books::set_free},
    {"remainder [J]", &Books::remainder},
}};

}  // namespace swage
