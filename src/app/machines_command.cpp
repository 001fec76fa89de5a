// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "app/command.h"
#include "app/scene_argument.h"
#include "app/table_text.h"
#include "app/word_wrap.h"
#include "base/error.h"
#include "base/text.h"
#include "base/units.h"
#include "scene/catalogue.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

struct MachinesArguments {
    std::string name, assets;
    bool json = false;
};

std::string range_text(const ParameterSpec& parameter) {
    if (parameter.low.empty() && parameter.high.empty()) return "";
    if (parameter.low.empty()) return ", up to " + parameter.high.text;
    if (parameter.high.empty()) return ", " + parameter.low.text + " or more";
    return ", " + parameter.low.text + " to " + parameter.high.text;
}

// As `swage keys` has it: what it takes, with the unit of a plain number.
std::string takes_text(const ParameterSpec& parameter) {
    const std::string unit = si_unit(parameter.quantity);
    return quantity_name(parameter.quantity) + (unit.empty() ? "" : " [" + unit + "]") +
           range_text(parameter) + "; default " + parameter.default_value.text;
}

std::string machine_text(const MachineSpec& machine) {
    std::string text =
        wrapped(machine.name + ": " + machine.help, 0, 2) + "\n  " + machine.file.string() + "\n\n";
    std::size_t column = 0;
    for (const ParameterSpec& p : machine.parameter) column = std::max(column, p.name.size() + 4);
    for (const ParameterSpec& parameter : machine.parameter) {
        std::string line = "  " + parameter.name;
        line.resize(column, ' ');
        text += line + wrapped(takes_text(parameter), column, column) + "\n";
        if (parameter.help.empty()) continue;
        text += std::string(column, ' ') + wrapped(parameter.help, column, column) + "\n";
    }
    std::vector<std::string> parts;
    const auto add = [&](const char* kind, const auto& all) {
        for (const auto& part : all) {
            parts.push_back(fmt::format("{} {}{}", kind, part.name,
                                        part.repeat.is_open() ? "_1, _2, ..." : ""));
        }
    };
    add("tool", machine.tool);
    add("grip", machine.grip);
    add("blade", machine.blade);
    for (const LoadSpec& load : machine.load) parts.push_back("load " + load.name);
    text += "\n  " + wrapped(joined(parts, ", "), 2, 2);
    text += machine.stops ? "\n  can stop at a force or torque ([[stage.limit]])"
                          : "\n  cannot stop at a force or torque";
    return text +
           "\n  numbers without a unit are in the unit in brackets; length, height and width are "
           "those of\n  the work-piece's box, spacing is that of its lattice\n";
}

Json machine_json(const MachineSpec& machine) {
    Json parameters = Json::array();
    for (const ParameterSpec& parameter : machine.parameter) {
        parameters.push_back({{"name", parameter.name},
                              {"quantity", quantity_name(parameter.quantity)},
                              {"unit", si_unit(parameter.quantity)},
                              {"default", parameter.default_value.text},
                              {"low", parameter.low.text},
                              {"high", parameter.high.text},
                              {"help", parameter.help}});
    }
    return {{"name", machine.name},           {"help", machine.help},
            {"file", machine.file.string()},  {"parameters", parameters},
            {"tools", machine.tool.size()},   {"grips", machine.grip.size()},
            {"blades", machine.blade.size()}, {"loads", machine.load.size()},
            {"can_stop", machine.stops}};
}

bool is_file(const MachinesArguments& given) { return given.name.ends_with(".toml"); }

// Of that file, or what a scene in `folder` can name.
MachineCatalogue catalogue_for(const MachinesArguments& given, const AssetPaths& assets,
                               const fs::path& folder) {
    if (!is_file(given)) return machine_catalogue(assets, folder, given.name);
    MachineReading reading = read_machine(given.name);
    MachineCatalogue one;
    one.mistakes = std::move(reading.mistakes);
    if (reading.machine) {
        one.machine.push_back(std::move(*reading.machine));
    } else {
        one.unusable.push_back({fs::path(given.name).stem().string(), given.name});
    }
    return one;
}

int machines(const MachinesArguments& given) {
    const AssetPaths assets = asset_paths(given.assets);
    const fs::path folder = fs::current_path();
    const MachineCatalogue catalogue = catalogue_for(given, assets, folder);
    log_mistakes(catalogue.mistakes);
    const std::string name = is_file(given) ? fs::path(given.name).stem().string() : given.name;
    for (const MachineFile& bad : catalogue.unusable) {
        if (bad.name != name && (!name.empty() || !catalogue.machine.empty())) continue;
        fail(ExitCode::scene, "{} does not make a usable machine", bad.file.string());
    }
    if (catalogue.machine.empty() && known_machines(assets, folder).empty()) {
        fail(ExitCode::command_line,
             "found no machine in {}; use --assets to name the folder that contains machines/{}",
             names_text(machine_folders(assets, folder)), wrong_root_text(assets.root));
    }
    if (given.name.empty()) {
        Json list = Json::array();
        std::vector<std::vector<std::string>> rows;
        for (const MachineSpec& machine : catalogue.machine) {
            list.push_back(machine_json(machine));
            rows.push_back({machine.name, machine.help});
        }
        if (given.json) {
            put_json(list);
        } else {
            put_out(table_text(rows) + "\nswage machines NAME shows a machine's parameters\n");
        }
        return 0;
    }
    const auto at = std::find_if(catalogue.machine.begin(), catalogue.machine.end(),
                                 [&](const MachineSpec& spec) { return spec.name == name; });
    if (at == catalogue.machine.end()) {
        fail(ExitCode::command_line, "{}",
             no_machine_text(given.name, known_machines(assets, folder),
                             machine_folders(assets, folder)));
    }
    if (given.json) {
        put_json(machine_json(*at));
    } else {
        put_out(machine_text(*at));
    }
    return 0;
}

}  // namespace

void add_machines_command(CLI::App& app, Action& chosen) {
    static MachinesArguments given;
    CLI::App* command =
        add_command(app, "machines", "List the machines, or show the parameters of one",
                    "  swage machines\n"
                    "  swage machines bend\n"
                    "  swage machines twist --json\n"
                    "  swage machines machines/press.toml\n",
                    chosen, [] { return machines(given); });
    command->add_option("name", given.name, "a machine, or the file of one")->type_name("NAME");
    add_assets_option(*command, given.assets);
    command->add_flag("--json", given.json, "print JSON");
}

}  // namespace swage
