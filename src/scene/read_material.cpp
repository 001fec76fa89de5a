// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_material.h"

#include <algorithm>
#include <cmath>

#include "base/suggest.h"
#include "base/text.h"
#include "base/units.h"
#include "laws/internal_damping.h"
#include "matter/material_names.h"
#include "scene/read_back_stress.h"
#include "scene/read_flow_curve.h"
#include "scene/read_look.h"

namespace swage {

namespace {

constexpr double kMuchFriction = 2;
constexpr double kRubberPoisson = 0.4;
constexpr double kMostStrength = 0.1;                   // of young_modulus
constexpr double kLeastYield = 1e-6, kMostYield = 0.2;  // likewise, of what there is
// Beyond all matter, and far from where numbers end.
constexpr Range kStiffness = {.low = 1e-3, .high = 1e15};  // [Pa]
constexpr Range kDensity = {.low = 1e-3, .high = 1e9};     // [kg/m3]

// Strength and toughness make sense together only; `strength = inf` takes both away.
void read_fracture(TableReader& table, Material& material) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const bool never = is_infinite(table.find("strength"));
    bool asks = false;
    if (never) {
        material.strength = kInfinite;
    } else {
        asks = table.quantity("strength", Quantity::stress, above(0), material.strength);
    }
    const bool has_toughness =
        table.quantity("toughness", Quantity::toughness, above(0), material.toughness);
    if (!material.breaks()) {
        material.toughness = kInfinite;
        return;
    }
    if (asks && !has_toughness && std::isinf(material.toughness)) {
        table.mistake(
            "strength",
            "strength needs toughness: the energy per area of a new crack, such as \"10 J/m2\"");
        return;
    }
    if (!(material.strength < kMostStrength * material.young_modulus)) {
        table.mistake(
            asks ? "strength" : "young_modulus",
            fmt::format("a strength of {} is too high for a young_modulus of {}: matter must break "
                        "at a strain of less than {:g}",
                        quantity_text(material.strength, Quantity::stress),
                        quantity_text(material.young_modulus, Quantity::stress), kMostStrength));
    }
    if (material.elasticity != Elasticity::hencky) {
        table.mistake("strength", fmt::format("{} matter does not break: leave out strength (or "
                                              "give inf), or use elasticity = \"hencky\"",
                                              name_in(kElasticityNames, material.elasticity)));
    }
}

// What its surface does where it meets another in motion.
void read_surface(TableReader& table, Material& material) {
    table.quantity("restitution", Quantity::number, between(0, 1), material.restitution);
    table.quantity("stickiness", Quantity::stress, at_least(0), material.stickiness);
    if (table.quantity("static_friction", Quantity::number, at_least(0),
                       material.static_friction) &&
        material.static_friction < material.friction) {
        table.mistake(
            "static_friction",
            fmt::format(
                "static_friction = {:g} is less than friction = {:g}: it must be at least as large",
                material.static_friction, material.friction));
    }
}

// A rubber or foam that is told to yield is taken as what can.
void take_as_yielding(TableReader& table, Material& material) {
    if (material.elasticity == Elasticity::hencky || !std::isfinite(material.yield_stress)) return;
    const std::string name = name_in(kElasticityNames, material.elasticity);
    material.elasticity = Elasticity::hencky;
    if (table.find("elasticity") != nullptr) {
        table.mistake("elasticity",
                      name +
                          " matter does not yield: leave out yield_stress (or give inf) and "
                          "flow_curve, or use elasticity = \"hencky\"");
    }
}

}  // namespace

void read_material_numbers(TableReader& table, bool needs_all, Material& material) {
    const bool has_modulus =
        table.quantity("young_modulus", Quantity::stress, kStiffness, material.young_modulus);
    table.quantity("poisson_ratio", Quantity::number, between(0, 0.49), material.poisson_ratio);
    table.choice<Elasticity>("elasticity", kElasticityNames, material.elasticity);
    if (material.mechanics == Mechanics::cells && material.elasticity == Elasticity::neo_hookean &&
        material.poisson_ratio < kRubberPoisson) {
        table.warn(
            "elasticity",
            fmt::format(
                "neo-hookean with poisson_ratio = {:g} is too soft under strong compression, and "
                "thins out: it is for rubber, from {:g} up; \"storakers\" is for foam",
                material.poisson_ratio, kRubberPoisson));
    }
    const bool has_density =
        table.quantity("density", Quantity::density, kDensity, material.density);
    read_flow(table, material);
    read_back_stress(table, material);
    take_as_yielding(table, material);
    read_fracture(table, material);
    table.quantity("damping_ratio", Quantity::number, between(0, kMostDampingRatio),
                   material.damping_ratio);
    if (table.quantity("friction", Quantity::number, at_least(0), material.friction) &&
        material.friction > kMuchFriction) {
        table.warn("friction", fmt::format("friction = {:g} is more than that of any known pair of "
                                           "materials; 0.1 to 1 is usual",
                                           material.friction));
    }
    read_surface(table, material);
    if (!needs_all) return;
    if (!has_modulus) table.missing("young_modulus", "a stress, such as \"2 GPa\"");
    if (!has_density) table.missing("density", "such as \"1200 kg/m3\"");
}

namespace {

const MaterialCatalogue& catalogue(Reading& reading, const AssetPaths& assets,
                                   const std::filesystem::path& scene_folder,
                                   std::vector<std::filesystem::path>& inputs) {
    if (!reading.materials) {
        MaterialCatalogue found = material_catalogue(assets, scene_folder);
        inputs.insert(inputs.end(), found.files.begin(), found.files.end());
        reading.mistakes.add(std::move(found.mistakes));
        reading.materials = std::make_shared<const MaterialCatalogue>(std::move(found));
    }
    return *reading.materials;
}

void take_known(TableReader& table, const std::string& name, const MaterialCatalogue& known,
                const AssetPaths& assets, Material& material,
                std::optional<SurfaceMaterial>& look) {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < known.material.size(); ++n) {
        if (known.material[n].name == name) {
            material = known.material[n];
            look = known.look[n];
            return;
        }
        names.push_back(known.material[n].name);
    }
    const std::string hint = did_you_mean(name, names);
    const std::string all = names.empty()
                                ? "; found no materials file" + wrong_root_text(assets.root)
                            : hint.empty() ? "; known: " + joined(names, ", ")
                                           : " Known: " + joined(names, ", ");
    table.mistake("name", fmt::format("there is no material \"{}\"{}{}", name, hint, all));
}

// What tables of materials agree on to within some times.
struct Measured {
    const char* key;
    Quantity quantity;
    double Material::*value;
};
constexpr Measured kMeasured[] = {
    {"young_modulus", Quantity::stress, &Material::young_modulus},
    {"density", Quantity::density, &Material::density},
    {"yield_stress", Quantity::stress, &Material::yield_stress},
    {"strength", Quantity::stress, &Material::strength},
    {"toughness", Quantity::toughness, &Material::toughness},
};

void warn_of_strange_change(TableReader& table, const char* key, Quantity quantity,
                            const Material& known, double was, double is) {
    const double times = is / was;
    const bool is_told = table.find(key) != nullptr && was > 0 && std::isfinite(was + is);
    if (!is_told || (times > 1 / kOtherMatter && times < kOtherMatter)) return;
    table.warn(key, fmt::format("{} is {:.1e} of what {} has, {}: is a unit missing or wrong?",
                                quantity_text(is, quantity), times, known.name,
                                quantity_text(was, quantity)));
}

bool is_strange_yield(const Material& material) {
    const double share = material.yield_stress / material.young_modulus;
    return std::isfinite(share) && !(share > kLeastYield && share < kMostYield);
}

void warn_of_strange_yield(TableReader& table, const Material& material) {
    const double share = material.yield_stress / material.young_modulus;
    for (const char* key : {"yield_stress", "flow_curve"}) {
        if (table.find(key) == nullptr) continue;
        table.warn(key, fmt::format("{} makes it flow at {}, {:.1e} of young_modulus: is a unit "
                                    "missing or wrong? Materials yield at {:g} to {:g} of it",
                                    key, quantity_text(material.yield_stress, Quantity::stress),
                                    share, kLeastYield, kMostYield));
    }
}

}  // namespace

void read_material(TableReader& table, const AssetPaths& assets,
                   const std::filesystem::path& scene_folder, Material& material,
                   std::optional<SurfaceMaterial>& look, std::vector<std::filesystem::path>& inputs,
                   bool is_there) {
    const Node* node = table.find("name");
    std::string name;
    const bool is_named = table.text("name", name);
    Material known;
    bool is_custom = !is_named;
    if (!name.empty()) {
        take_known(table, name, catalogue(table.reading(), assets, scene_folder, inputs), assets,
                   material, look);
        known = material;
    } else if (is_named && node->kind == Node::Kind::text) {
        table.mistake("name", "the material's name is empty");
    } else if (!is_there) {
        if (table.reading().is_complete) {
            table.mistake("name",
                          "the section [material] is missing: give it a name, such as "
                          "name = \"rubber\", or young_modulus and density");
        }
        is_custom = false;
    }
    table.choice<Mechanics>("mechanics", kMechanicsNames, material.mechanics);
    read_material_numbers(table, is_custom, material);
    read_look(table, look);
    const bool yields_strangely = is_strange_yield(material);
    if (yields_strangely) warn_of_strange_yield(table, material);
    if (!known.name.empty() && known.name == name) {
        for (const auto& [key, quantity, value] : kMeasured) {
            if (yields_strangely && value == &Material::yield_stress) continue;
            warn_of_strange_change(table, key, quantity, known, known.*value, material.*value);
        }
    }
    table.finish();
}

}  // namespace swage
