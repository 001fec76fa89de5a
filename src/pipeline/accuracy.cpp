// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "base/units.h"
#include "base/whole.h"
#include "geometry/mesh_check.h"
#include "laws/fracture.h"

namespace swage {

namespace {

// `swage verify oblique-bar oblique-rod`: bending 5.68 % at 4 cells and 1.36 % at 8 (the rod),
// torsion 6.87 % and 1.93 % (the bar); both fall with the square.
constexpr double kBending = 0.91, kTorsion = 1.24;

// With which the spacing resolves it [J/m2].
double toughness_for(const Material& material, double spacing) {
    return kLeastReach * spacing * material.strength * material.strength / material.young_modulus;
}

// Three figures tell it; of a bound the next above.
double told(double value, double (*round)(double) = std::round) {
    const double unit = portable::pow(10, std::floor(portable::log10(value)) - 2);
    return unit * round(value / unit);
}

}  // namespace

Accuracy accuracy_at(double cells) {
    const double square = cells * cells;
    return {kBending / square, kTorsion / square,
            static_cast<int>(std::ceil(std::sqrt(std::max(kBending, kTorsion) / 0.01)))};
}

Resolved resolved_strength(const Material& material, double spacing, double cells) {
    if (!material.breaks()) return {material.strength, 0};
    const double e = material.young_modulus, strength = material.strength;
    const double needed = fracture_reach(e, strength, material.toughness) / kLeastReach;
    if (spacing <= needed * (1 + 1e-9)) return {strength, 0};
    return {strength_at(e, strength, material.toughness, spacing),
            to_int(std::ceil(cells * spacing / needed))};
}

std::string strength_warning(const Material& material, double spacing, double cells,
                             const std::string& section, const Advisable& most) {
    const Resolved resolved = resolved_strength(material, spacing, cells);
    if (resolved.whole()) return "";
    const std::string name = material.name == Material{}.name ? "the material" : material.name;
    const double toughness = told(toughness_for(material, spacing), std::ceil);
    const bool is_strange = toughness >= most.toughness;
    const std::string tougher =
        is_strange ? "" : "a toughness of " + quantity_text(toughness, Quantity::toughness);
    std::string advice;
    if (resolved.cells_for_whole <= most.across && resolved.cells_for_whole < kMostAcross) {
        advice = fmt::format("{} across = {} would suffice{}", section, resolved.cells_for_whole,
                             is_strange ? "" : ", or at this one " + tougher);
    } else {
        advice = resolved.cells_for_whole < kMostAcross
                     ? fmt::format(
                           "no lattice within its cell_limit is fine enough ({} across = {} "
                           "would be)",
                           section, resolved.cells_for_whole)
                     : "no cell size is fine enough";
        advice += is_strange
                      ? fmt::format("; at this one it takes more toughness than any {} has", name)
                      : "; at this one it takes " + tougher;
    }
    return fmt::format(
        "cells of {} do not resolve how {} breaks: cracks run at the right load, but a smooth part "
        "breaks at {} instead of {}; {}",
        length_text(spacing), name, quantity_text(told(resolved.strength), Quantity::stress),
        quantity_text(material.strength, Quantity::stress), advice);
}

}  // namespace swage
