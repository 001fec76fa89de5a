// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_stage.h"

#include <algorithm>
#include <cmath>

#include "machines/parameters.h"
#include "machines/repeat.h"
#include "scene/expressions.h"
#include "scene/file_text.h"
#include "scene/read_limit.h"
#include "scene/read_load.h"
#include "scene/read_machine.h"
#include "scene/read_solver.h"
#include "scene/stage_keys.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

constexpr int kMostFrames = 1'000'000'000;  // of a scene; what a machine can hold is judged later

const std::vector<std::string> kStageKeys = {"machine",
                                             "name",
                                             "frames",
                                             "duration",
                                             "axis",
                                             "up",
                                             "remold",
                                             "solver",
                                             "gravity",
                                             "gravity_strength",
                                             "load",
                                             "limit",
                                             "medium_density",
                                             "drag_coefficient",
                                             "directional_drag",
                                             "directional_drag_along",
                                             "tolerance",
                                             "iteration_limit",
                                             "halving_limit",
                                             "contact_stiffness",
                                             "grip_stiffness",
                                             "step_safety",
                                             "retry_limit",
                                             "self_contact",
                                             "sleep"};

bool is_path(const std::string& machine) {
    return machine.find('/') != std::string::npos || fs::path(machine).extension() == ".toml";
}

// What a stage leaves to its machine, that says, unless it would lie along what the stage says.
void fall_back(TableReader& table, const MachineSpec& machine, StageSpec& stage) {
    using enum WorldAxis;
    if (stage.axis == automatic && !lie_along(machine.axis, stage.up)) stage.axis = machine.axis;
    if (stage.up != automatic) return;
    if (!lie_along(stage.axis, machine.up)) {
        stage.up = machine.up;
    } else if (machine.upright) {
        table.mistake("axis", fmt::format("axis = \"{}\" points up with machine {}, whose up is "
                                          "\"{}\"; choose another, or also give up",
                                          name_of(stage.axis), machine.name, name_of(machine.up)));
    }
}

}  // namespace

bool is_stage_key(const std::string& key) {
    return std::find(kStageKeys.begin(), kStageKeys.end(), key) != kStageKeys.end();
}

std::string usual_stage_name(std::size_t number, const std::string& machine) {
    return fmt::format(
        "{}-{}", number,
        is_path(machine) ? fs::path(machine).lexically_normal().stem().string() : machine);
}

std::optional<std::string> why_no_file_name(const std::string& text) {
    constexpr std::size_t kLongest = 100;
    if (text.empty()) return "is empty";
    if (text.size() > kLongest) return fmt::format("is longer than {} bytes", kLongest);
    if (text[0] == '.') return "begins with a dot";
    if (text.front() == ' ' || text.back() == ' ') return "begins or ends with a blank";
    for (char c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            return "contains a control character";
        if (std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos) {
            return fmt::format("contains \"{}\"", c);
        }
    }
    return std::nullopt;
}

StageReader::StageReader(Reading& reading, const AssetPaths& assets, fs::path scene_folder,
                         const SceneSpec& scene)
    : reading_(reading), scene_folder_(std::move(scene_folder)), scene_(scene) {
    reading_.known["[[stage]]"].insert(kStageKeys.begin(), kStageKeys.end());
    folders_ = machine_folders(assets, scene_folder_);
    known_ = known_machines(assets, scene_folder_);
}

const StageReader::Loaded* StageReader::load(const fs::path& file) {
    const auto [at, is_new] = loaded_.try_emplace(file);
    Loaded& loaded = at->second;
    if (is_new) {
        MachineReading read = read_machine(file);
        reading_.mistakes.add(std::move(read.mistakes));
        loaded.machine = std::move(read.machine);
        inputs_.push_back(file);
        if (loaded.machine) {
            loaded.ranges.emplace(*loaded.machine);
            for (const ToolSpec& tool : loaded.machine->tool) {
                if (!tool.mesh.empty()) inputs_.push_back(tool.mesh);
            }
        }
    }
    return &loaded;
}

const StageReader::Loaded* StageReader::find_machine(TableReader& table, std::string& name) {
    std::string wanted;
    if (!table.text("machine", wanted)) {
        table.missing("machine", "one of " + names_text(known_));
        return nullptr;
    }
    if (wanted.empty()) {
        if (table.find("machine")->kind == Node::Kind::text) {
            table.mistake("machine", "machine is empty; known: " + names_text(known_));
        }
        return nullptr;
    }
    if (is_path(wanted)) {
        const fs::path file = (scene_folder_ / wanted).lexically_normal();
        name = file.stem().string();
        if (const auto reason = why_unreadable(file)) {
            table.mistake("machine", fmt::format("the machine file \"{}\" {} ({})", wanted, *reason,
                                                 file.string()));
            return nullptr;
        }
        return load(file);
    }
    name = wanted;
    for (const MachineFile& one : known_) {
        if (one.name == wanted) return load(one.file);
    }
    table.mistake("machine", no_machine_text(wanted, known_, folders_));
    return nullptr;
}

bool StageReader::read_parameters(TableReader& table, const Loaded& loaded, StageSpec& stage) {
    for (const ParameterSpec& parameter : loaded.machine->parameter) {
        double value = std::numeric_limits<double>::quiet_NaN();
        table.quantity(parameter.name, parameter.quantity, {}, value);
        if (std::isnan(value)) continue;
        stage.parameter[parameter.name] = value;
        stage.parameter_place[parameter.name] = table.find(parameter.name)->place;
    }
    bool are_in_range = true;
    if (stage.parameter.empty()) return are_in_range;
    const std::vector<Range> ranges = loaded.ranges->ranges(stage.parameter);
    for (std::size_t n = 0; n < ranges.size(); ++n) {
        const ParameterSpec& parameter = loaded.machine->parameter[n];
        const auto given = stage.parameter.find(parameter.name);
        if (given == stage.parameter.end()) continue;
        if (ranges[n].nearly_holds(given->second)) continue;
        are_in_range = false;
        table.mistake(parameter.name,
                      fmt::format("{} = {} is out of range: machine {} takes {}", parameter.name,
                                  quantity_text(given->second, parameter.quantity),
                                  loaded.machine->name, ranges[n].text(parameter.quantity)));
    }
    return are_in_range;
}

// What comes after them sees the machine's parts.
void StageReader::repeat_parts(TableReader& table, const Loaded& loaded, StageSpec& stage) {
    try {
        stage.machine = with_single_parts(stage.machine, loaded.ranges->values(stage.parameter));
    } catch (const ParameterError& error) {
        for (const ParameterMistake& mistake : error.mistakes()) {
            table.mistake(
                stage.parameter.contains(mistake.parameter) ? mistake.parameter : "machine",
                mistake.sentence);
        }
    }
}

// The machine's own expressions see the same names.
void StageReader::read_loads(TableReader& table, StageSpec& stage) {
    ExpressionReader expression;
    expression.add_names(work_piece_names());
    std::set<std::string> parts = {"gravity"};
    for (const ParameterSpec& parameter : stage.machine.parameter) {
        expression.add_name(parameter.name);
    }
    for (const ToolSpec& tool : stage.machine.tool) {
        for (const char* axis : {"_x", "_y", "_z"}) expression.add_name(tool.name + axis);
        parts.insert(tool.name);
    }
    for (const GripSpec& grip : stage.machine.grip) parts.insert(grip.name);
    for (const BladeSpec& blade : stage.machine.blade) parts.insert(blade.name);
    for (const LoadSpec& load : stage.machine.load) parts.insert(load.name);
    std::size_t number = 0;
    for (const Node* node : table.tables("load", "[[stage.load]]")) {
        TableReader one(*node, "[[stage.load]]", reading_);
        LoadSpec load;
        load.name = usual_load_name(++number);
        if (one.find("name") != nullptr) {
            load.name = read_part_name(one, parts);
        } else if (!parts.insert(load.name).second) {
            one.mistake("name", fmt::format("two parts are called \"{}\"; give this load a name",
                                            load.name));
        }
        read_load_keys(one, expression, load);
        one.finish();
        stage.machine.load.push_back(std::move(load));
    }
    ExpressionReader timed = expression.timed();
    timed.read(table, "gravity_strength", Quantity::number, stage.machine.gravity_strength);
    expression.take_used(timed);
    stage.machine.stops = stage.machine.stops || expression.is_used(kStop);
}

void read_frame_words(TableReader& table, WorldAxis& axis, WorldAxis& up) {
    const auto named = [](const std::vector<WorldAxis>& choices) {
        std::vector<std::pair<std::string, WorldAxis>> pairs;
        for (const WorldAxis choice : choices) pairs.emplace_back(name_of(choice), choice);
        return pairs;
    };
    using enum WorldAxis;
    table.choice("axis", named({automatic, x, y, z}), axis);
    table.choice("up", named({automatic, x, minus_x, y, minus_y, z, minus_z}), up);
    if (lie_along(axis, up)) {
        table.mistake("up", fmt::format("up = \"{}\" lies along axis = \"{}\"; choose another",
                                        name_of(up), name_of(axis)));
    }
}

void StageReader::name_stage(TableReader& table, StageSpec& stage) {
    const Node* machine = table.find("machine");
    const bool has_machine = machine != nullptr && machine->kind == Node::Kind::text;
    stage.name = usual_stage_name(count_, has_machine ? machine->text : "");
    const bool is_named = table.text("name", stage.name);
    if (const auto reason = why_no_file_name(stage.name); is_named && reason) {
        table.mistake("name", fmt::format("the name {}; it is used in file names", *reason));
        return;
    }
    const Place& place = table.find("name") != nullptr ? table.find("name")->place : table.place();
    const auto [earlier, is_new] = line_of_name_.try_emplace(stage.name, place.line);
    if (!is_new) {
        table.mistake("name", fmt::format("two stages are called \"{}\"; the first is on line {}",
                                          stage.name, earlier->second));
    }
}

StageSpec StageReader::read(const Node& node) {
    ++count_;
    TableReader table(node, "[[stage]]", reading_);
    StageSpec stage;
    std::string machine;
    const Loaded* loaded = find_machine(table, machine);
    const Node* named = table.find("machine");
    stage.place = named != nullptr ? named->place : table.place();
    name_stage(table, stage);
    if (table.whole("frames", 1, kMostFrames, stage.frames)) {
        frames_ += stage.frames;
        if (frames_ - stage.frames <= kMostFrames && frames_ > kMostFrames) {
            table.mistake("frames", fmt::format("the scene has more than {} frames", kMostFrames));
        }
    } else {
        frames_ += stage.frames;
    }
    table.quantity("duration", Quantity::time, above(0), stage.duration);
    table.truth("remold", stage.remold);
    read_frame_words(table, stage.axis, stage.up);
    const bool has_machine = loaded != nullptr && loaded->machine;
    if (has_machine) fall_back(table, *loaded->machine, stage);
    read_solver(table, scene_, has_machine ? &*loaded->machine : nullptr,
                has_machine && loaded->machine->upright ? stage.up : WorldAxis::automatic,
                stage.remold, stage.sim);
    if (has_machine) {
        stage.machine = *loaded->machine;
        table.narrow(fmt::format("[[stage]] with machine \"{}\"", machine));
        if (read_parameters(table, *loaded, stage)) repeat_parts(table, *loaded, stage);
        read_loads(table, stage);
        read_limits(table, stage.sim.solver, stage.machine);
    } else if (reading_.describes) {
        read_loads(table, stage);  // their keys are the same with every machine
        read_limits(table, stage.sim.solver, stage.machine);
    } else {
        for (const char* key : {"load", "gravity_strength", "limit"}) table.find(key);
        table.leave_unknown();
    }
    table.finish();
    return stage;
}

}  // namespace swage
