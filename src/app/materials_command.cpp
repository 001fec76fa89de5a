// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "app/command.h"
#include "app/scene_argument.h"
#include "app/table_text.h"
#include "base/error.h"
#include "base/srgb.h"
#include "base/suggest.h"
#include "base/units.h"
#include "matter/material_names.h"
#include "pipeline/given_record.h"
#include "scene/catalogue.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

struct MaterialsArguments {
    std::string name, assets;
    bool json = false;
};

std::string limit_text(double stress) {
    return std::isfinite(stress) ? quantity_text(stress, Quantity::stress) : "-";
}

std::string list_text(const std::vector<Material>& materials) {
    std::vector<std::vector<std::string>> rows = {
        {"MATERIAL", "STIFFNESS", "POISSON", "DENSITY", "FLOWS AT", "BREAKS AT"}};
    for (const Material& m : materials) {
        rows.push_back({m.name, quantity_text(m.young_modulus, Quantity::stress),
                        fmt::format("{:g}", m.poisson_ratio),
                        quantity_text(m.density, Quantity::density), limit_text(m.yield_stress),
                        limit_text(m.strength)});
    }
    return table_text(rows) +
           "\nswage materials NAME shows all numbers of one, as a scene would give them\n";
}

Vec3 on_screen(const Vec3& color) {
    return {srgb_from_linear(color.x()), srgb_from_linear(color.y()), srgb_from_linear(color.z())};
}

std::string look_text(const SurfaceMaterial& look) {
    const Vec3 c = on_screen(look.color);
    return fmt::format(
        "look = {{color = [{:.3g}, {:.3g}, {:.3g}], roughness = {:g}, metalness = {:g}, clear = "
        "{:g}}}\n",
        c.x(), c.y(), c.z(), look.roughness, look.metallic, look.clear);
}

Json told(const Material& material, const std::optional<SurfaceMaterial>& look) {
    Json json = material_json(material);
    if (!look) return json;
    const Vec3 c = on_screen(look->color);
    json["look"] = {{"color", {c.x(), c.y(), c.z()}},
                    {"roughness", look->roughness},
                    {"metalness", look->metallic},
                    {"clear", look->clear}};
    return json;
}

// As a scene may say it.
std::string material_text(const Material& m, const std::optional<SurfaceMaterial>& look) {
    std::string text = fmt::format("[material]\nname = \"{}\"\n", m.name);
    const auto number = [&](const char* key, double value) {
        text += fmt::format("{} = {:g}\n", key, value);
    };
    const auto quantity = [&](const char* key, double value, Quantity kind) {
        text += fmt::format("{} = \"{}\"\n", key, quantity_text(value, kind));
    };
    quantity("young_modulus", m.young_modulus, Quantity::stress);
    number("poisson_ratio", m.poisson_ratio);
    quantity("density", m.density, Quantity::density);
    if (m.elasticity != Elasticity::hencky) {
        text += fmt::format("elasticity = \"{}\"\n", name_in(kElasticityNames, m.elasticity));
    }
    if (!m.flow_curve.empty()) {
        text += fmt::format("# yields at {}, then follows a flow curve that comes with the name\n",
                            quantity_text(m.yield_stress, Quantity::stress));
    } else if (m.yields()) {
        quantity("yield_stress", m.yield_stress, Quantity::stress);
        quantity("hardening", m.hardening, Quantity::stress);
    }
    if (m.back_stress > 0) {
        quantity("back_stress", m.back_stress, Quantity::stress);
        number("back_strain", m.back_strain);
    }
    if (m.breaks()) {
        quantity("strength", m.strength, Quantity::stress);
        quantity("toughness", m.toughness, Quantity::toughness);
    }
    number("friction", m.friction);
    if (m.static_friction > m.friction) number("static_friction", m.static_friction);
    text += "# only in motion:\n";
    number("damping_ratio", m.damping_ratio);
    number("restitution", m.restitution);
    if (m.stickiness > 0) quantity("stickiness", m.stickiness, Quantity::stress);
    if (look) text += "# only in pictures:\n" + look_text(*look);
    return text;
}

int materials(const MaterialsArguments& given) {
    const AssetPaths assets = asset_paths(given.assets);
    const MaterialCatalogue catalogue = material_catalogue(assets, fs::current_path());
    log_mistakes(catalogue.mistakes);
    if (exit_code(catalogue.mistakes) != ExitCode::done) {
        fail(ExitCode::scene, "a materials file has mistakes");
    }
    if (catalogue.material.empty()) {
        fail(ExitCode::command_line, "found no materials file{}", wrong_root_text(assets.root));
    }
    if (given.name.empty()) {
        Json list = Json::array();
        for (std::size_t n = 0; n < catalogue.material.size(); ++n) {
            list.push_back(told(catalogue.material[n], catalogue.look[n]));
        }
        if (given.json) {
            put_json(list);
        } else {
            put_out(list_text(catalogue.material));
        }
        return 0;
    }
    std::vector<std::string> known;
    for (std::size_t n = 0; n < catalogue.material.size(); ++n) {
        const Material& one = catalogue.material[n];
        known.push_back(one.name);
        if (one.name != given.name) continue;
        if (given.json) {
            put_json(told(one, catalogue.look[n]));
        } else {
            put_out(material_text(one, catalogue.look[n]));
        }
        return 0;
    }
    fail(ExitCode::command_line, "there is no material \"{}\"{}", given.name,
         hint_and(did_you_mean(given.name, known), "the command swage materials lists them"));
}

}  // namespace

void add_materials_command(CLI::App& app, Action& chosen) {
    static MaterialsArguments given;
    CLI::App* command =
        add_command(app, "materials", "List the materials, or show the numbers of one",
                    "  swage materials\n"
                    "  swage materials rubber\n"
                    "  swage materials aluminium --json\n",
                    chosen, [] { return materials(given); });
    command->add_option("name", given.name, "A material")->type_name("NAME");
    add_assets_option(*command, given.assets);
    command->add_flag("--json", given.json, "print JSON");
}

}  // namespace swage
