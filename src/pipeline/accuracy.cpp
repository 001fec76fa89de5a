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
                             const std::string& section, double most_across) {
    const Resolved resolved = resolved_strength(material, spacing, cells);
    if (resolved.whole()) return "";
    std::string finer = "no cell size is fine enough; at this one it takes";
    if (resolved.cells_for_whole <= most_across && resolved.cells_for_whole < kMostAcross) {
        finer = fmt::format("{} across = {} would suffice, or at this one", section,
                            resolved.cells_for_whole);
    } else if (resolved.cells_for_whole < kMostAcross) {
        finer = fmt::format(
            "no lattice within its cell_limit is fine enough ({} across = {} would be); at this "
            "one it takes",
            section, resolved.cells_for_whole);
    }
    return fmt::format(
        "cells of {} do not resolve how {} breaks: cracks run at the right load, but a smooth part "
        "breaks at {} instead of {}; {} a toughness of {}",
        length_text(spacing), material.name == Material{}.name ? "the material" : material.name,
        quantity_text(told(resolved.strength), Quantity::stress),
        quantity_text(material.strength, Quantity::stress), finer,
        quantity_text(told(toughness_for(material, spacing), std::ceil), Quantity::toughness));
}

}  // namespace swage
