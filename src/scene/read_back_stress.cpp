// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_back_stress.h"

#include <cmath>

#include "base/units.h"
#include "laws/isotropic_part.h"

namespace swage {

namespace {

constexpr double kMostStress = 1e15;  // [Pa]
constexpr double kLeastStrain = 1e-6, kMostStrain = 10;
constexpr double kMostSteep = 0.5;   // of young_modulus: with more a return has no one end
constexpr double kLeastLeft = 0.05;  // of the stress at which flow begins

}  // namespace

void read_back_stress(TableReader& table, Material& material) {
    const bool has_stress = table.quantity("back_stress", Quantity::stress, between(0, kMostStress),
                                           material.back_stress);
    const bool has_strain = table.quantity(
        "back_strain", Quantity::number, between(kLeastStrain, kMostStrain), material.back_strain);
    if (!(material.back_stress > 0)) {
        if (has_strain) table.warn("back_strain", "back_strain has no effect without back_stress");
        return;
    }
    if (!material.yields()) {
        if (has_stress) table.warn("back_stress", "back_stress has no effect without yield_stress");
        material.back_stress = 0;
        return;
    }
    // What this file says of it.
    const char* key = "back_stress";
    for (const char* said : {"mechanics", "young_modulus", "hardening", "yield_stress",
                             "flow_curve", "back_strain", "back_stress"}) {
        if (table.find(said) != nullptr) key = said;
    }
    const auto text = [](double stress) { return quantity_text(stress, Quantity::stress); };
    if (!(material.back_strain > 0)) {
        if (table.find("back_strain") != nullptr) return;  // told already
        table.mistake("back_stress",
                      "back_stress needs back_strain: the plastic strain over which it builds up, "
                      "such as 0.01");
        return;
    }
    if (material.mechanics == Mechanics::springs) {
        table.mistake(key,
                      "springs have no back stress: use mechanics = \"cells\" or back_stress = 0");
        return;
    }
    const double steep = material.back_stress / material.back_strain;
    if (steep > kMostSteep * material.young_modulus) {
        table.mistake(key,
                      fmt::format("a back_stress of {} over a back_strain of {:g} builds up by {}: "
                                  "at most {:g} of young_modulus, {}, is allowed",
                                  text(material.back_stress), material.back_strain, text(steep),
                                  kMostSteep, text(kMostSteep * material.young_modulus)));
        return;
    }
    const FlowPoint least =
        least_isotropic(material.yield_stress, material.hardening, material.flow_curve,
                        material.back_stress, material.back_strain);
    if (least.stress >= kLeastLeft * material.yield_stress) return;
    const std::string where = std::isinf(least.strain)
                                  ? "at large strain"
                                  : fmt::format("at a plastic strain of {:.3g}", least.strain);
    table.mistake(key,
                  fmt::format("a back_stress of {} leaves {} of the flow stress {}, and at least "
                              "{} is needed: give less, or let hardening or flow_curve rise by as "
                              "much, as {{s0 = \"{}\", Q = \"{}\", b = {:g}}} does",
                              text(material.back_stress), text(least.stress), where,
                              text(kLeastLeft * material.yield_stress), text(material.yield_stress),
                              text(material.back_stress), 1 / material.back_strain));
}

}  // namespace swage
