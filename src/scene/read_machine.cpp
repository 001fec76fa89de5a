// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_machine.h"

#include <algorithm>

#include "base/text.h"
#include "machines/repeat.h"
#include "scene/expressions.h"
#include "scene/file_text.h"
#include "scene/read_color.h"
#include "scene/read_load.h"
#include "scene/read_parameters.h"
#include "scene/read_stage.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

class MachineReader {
  public:
    MachineReader(const fs::path& folder, Reading& reading)
        : folder_(folder), mistakes_(reading.mistakes), reading_(reading) {
        expression_.add_names(work_piece_names());
    }

    void read(const Document& document, MachineSpec& machine) {
        reading_.is_complete = document.is_complete;
        TableReader root(document.root, "the machine file", reading_);
        root.text("help", machine.help);
        root.truth("moves", machine.moves);
        root.truth("upright", machine.upright);
        read_frame_words(root, machine.axis, machine.up);
        if (machine.upright && machine.up == WorldAxis::automatic) {
            machine.up = WorldAxis::y;  // gravity's way does not depend on what lies on the machine
            if (machine.axis == WorldAxis::y) {
                root.mistake("axis",
                             "axis = \"y\" points up in an upright machine; choose another, or "
                             "also give up = \"z\"");
            }
        }
        read_parameters(root.table("parameter"), reading_, machine, expression_, counting_);
        for (const Node* node : root.tables("tool", "[[tool]]")) read_tool(*node, machine);
        // From here on the places of all tools are known, and motions also see the time.
        std::size_t number = 0;
        for (const Node* node : root.tables("tool", "[[tool]]")) {
            TableReader table(*node, "[[tool]]", reading_);
            ToolSpec& tool = machine.tool[number++];
            ExpressionReader seen = expression_;
            if (tool.repeat.is_open()) {
                seen = expression_.repeated();
                seen.add_names(middle_names(tool.name));
            }
            read_motion(table, "[tool.motion]", seen, tool.motion);
        }
        for (const Node* node : root.tables("grip", "[[grip]]")) read_grip(*node, machine);
        for (const Node* node : root.tables("blade", "[[blade]]")) read_blade(*node, machine);
        for (const Node* node : root.tables("load", "[[load]]")) read_load(*node, machine);
        for (const Node* node : root.tables("check", "[[check]]")) read_check(*node, machine);
        root.finish();
        refuse_numbered_names();
        machine.stops = expression_.is_used(kStop);
        if (machine.tool.empty() && machine.grip.empty() && machine.blade.empty() &&
            machine.load.empty() && reading_.is_complete) {
            mistakes_.add({document.source, 0, 0},
                          "this machine has no [[tool]], [[grip]] or [[blade]]");
        }
        warn_of_unused(document.root);
        reading_.report_unknown();
    }

  private:
    // What reads the other expressions of the part.
    ExpressionReader read_repeat(TableReader& table, Repetition& repeat) {
        if (!counting_.read(table, "repeat", repeat.count)) return expression_;
        expression_.take_used(counting_);
        counting_.expect_count(table, "repeat", kMostRepeats);
        return expression_.repeated();
    }

    std::string read_name(TableReader& table, const Repetition& repeat) {
        const std::string name = read_part_name(table, part_names_);
        const Node* given = table.find("name");
        if (given != nullptr) parts_.push_back({name, given->place, repeat.is_open()});
        return name;
    }

    // No other part may be called as one of those that are repeated.
    void refuse_numbered_names() {
        for (const Part& repeated : parts_) {
            if (!repeated.is_repeated) continue;
            for (const Part& part : parts_) {
                if (!is_numbered(part.name, repeated.name)) continue;
                mistakes_.add(part.place,
                              fmt::format("\"{}\" is also the name of a repeated \"{}\"; "
                                          "choose another name",
                                          part.name, repeated.name));
            }
        }
    }

    void read_tool(const Node& node, MachineSpec& machine) {
        TableReader table(node, "[[tool]]", reading_);
        ToolSpec tool;
        ExpressionReader expression = read_repeat(table, tool.repeat);
        tool.name = read_name(table, tool.repeat);
        refuse_parameters_named_as(tool, table, machine);
        read_shape(table, expression, tool);
        expression.read(table, "axis", Quantity::number, tool.axis);
        expression.expect_direction(table);
        expression.read(table, "turn", Quantity::angle, tool.turn);
        if (!expression.read(table, "at", Quantity::length, tool.at)) {
            table.missing("at", "the position of its centre, such as [0, \"-height\", 0]");
        }
        expression.read(table, "touch", Quantity::number, tool.touch);
        expression.read(table, "gap", Quantity::length, tool.gap);
        if (table.find("gap") != nullptr && table.find("touch") == nullptr) {
            table.warn("gap", "gap has no effect without touch");
        }
        expression.read(table, "friction", Quantity::number, tool.friction);
        table.quantity("contact_stiffness", Quantity::number, between(0.5, 100),
                       tool.contact_stiffness);
        read_color(table, tool.color);
        table.choice<Finish>(
            "finish",
            {{"metal", Finish::metal}, {"matt", Finish::matt}, {"endless", Finish::endless}},
            tool.finish);
        table.find("motion");
        if (tool.shape == ToolShape::none) table.leave_unknown();
        table.finish();
        expression_.take_used(expression);
        if (tool.repeat.is_open()) {
            for (const std::string& middle : middle_names(tool.name)) {
                expression_.explain(
                    middle, "only its own motion sees the middle of a tool that is repeated");
            }
        } else {
            expression_.add_names(middle_names(tool.name));
        }
        machine.tool.push_back(std::move(tool));
    }

    static void refuse_parameters_named_as(const ToolSpec& tool, TableReader& table,
                                           const MachineSpec& machine) {
        for (const ParameterSpec& parameter : machine.parameter) {
            for (const std::string axis : {"_x", "_y", "_z"}) {
                if (!parameter.name.ends_with(axis)) continue;
                const std::string whose =
                    parameter.name.substr(0, parameter.name.size() - axis.size());
                const bool is_single = tool.repeat.is_open() && is_numbered(whose, tool.name);
                if (whose != tool.name && !is_single) continue;
                table.mistake("name", fmt::format("\"{}\" is a parameter, and would also be the "
                                                  "position of tool \"{}\"; choose another name",
                                                  parameter.name, whose));
            }
        }
    }

    void read_shape(TableReader& table, ExpressionReader& expression, ToolSpec& tool) {
        const bool has_shape = table.choice<ToolShape>("shape",
                                                       {{"cylinder", ToolShape::cylinder},
                                                        {"box", ToolShape::box},
                                                        {"sphere", ToolShape::sphere},
                                                        {"mesh", ToolShape::mesh}},
                                                       tool.shape);
        if (!has_shape) table.missing("shape", "\"cylinder\", \"box\", \"sphere\" or \"mesh\"");
        const auto is = [&](ToolShape shape) { return tool.shape == shape; };
        const bool is_round = is(ToolShape::cylinder) || is(ToolShape::sphere);
        const bool is_long = is(ToolShape::cylinder) || is(ToolShape::mesh);
        if (is_round) read_size(table, "radius", expression, tool.radius);
        if (is_long) read_size(table, "length", expression, tool.length);
        if (is(ToolShape::box)) {
            if (!expression.read(table, "size", Quantity::length, tool.size)) {
                table.missing("size", "three lengths along x, y and z");
            }
            expression.expect_positive(table, "size");
        }
        if (is(ToolShape::cylinder)) expression.read(table, "hole", Quantity::length, tool.hole);
        if (is(ToolShape::cylinder) || is(ToolShape::box)) {
            expression.read(table, "rounding", Quantity::length, tool.rounding);
        }
        if (is(ToolShape::mesh)) read_tool_mesh(table, tool.mesh, tool.mesh_place);
    }

    static std::vector<std::string> middle_names(const std::string& tool) {
        return {tool + "_x", tool + "_y", tool + "_z"};
    }

    static void read_size(TableReader& table, const std::string& key, ExpressionReader& expression,
                          Expression& into) {
        if (expression.read(table, key, Quantity::length, into)) {
            expression.expect_positive(table, key);
        } else {
            table.missing(key, "a length");
        }
    }

    void read_tool_mesh(TableReader& table, fs::path& mesh, TextPlace& place) {
        std::string name;
        if (!table.text("file", name)) {
            table.missing("file", "the mesh, relative to the machine file");
            return;
        }
        mesh = (folder_ / name).lexically_normal();
        place = text_place(table.find("file")->place);
        if (const auto reason = why_no_mesh(mesh)) {
            table.mistake("file",
                          fmt::format("the mesh \"{}\" {} ({})", name, *reason, mesh.string()),
                          ExitCode::mesh);
        }
    }

    void read_motion(TableReader& part, const std::string& section, ExpressionReader& expression,
                     MotionSpec& motion, bool stops = true) {
        TableReader table(part.table("motion"), section, reading_);
        ExpressionReader timed = expression.timed(stops);
        timed.read(table, "move", Quantity::length, motion.move);
        const bool turns = timed.read(table, "turn", Quantity::angle, motion.turn);
        const bool has_axis = expression.read(table, "axis", Quantity::number, motion.axis);
        expression.expect_direction(table);
        const bool has_pivot = timed.read(table, "pivot", Quantity::length, motion.pivot);
        if (!turns && (has_axis || has_pivot)) {
            table.warn(has_axis ? "axis" : "pivot", "axis and pivot have no effect without turn");
        }
        expression_.take_used(expression);
        expression_.take_used(timed);
        table.finish();
    }

    void read_grip(const Node& node, MachineSpec& machine) {
        TableReader table(node, "[[grip]]", reading_);
        GripSpec grip;
        ExpressionReader expression = read_repeat(table, grip.repeat);
        grip.name = read_name(table, grip.repeat);
        if (!expression.read(table, "from", Quantity::length, grip.from)) {
            table.missing("from", "a corner of a box");
        }
        if (!expression.read(table, "to", Quantity::length, grip.to)) {
            table.missing("to", "the opposite corner");
        }
        read_along(table, grip.along);
        table.truth("drawn", grip.drawn);
        read_motion(table, "[grip.motion]", expression, grip.motion);
        table.finish();
        machine.grip.push_back(std::move(grip));
    }

    void read_along(TableReader& table, std::array<bool, 3>& along) {
        std::string axes;
        if (!table.text("along", axes)) return;
        along = {false, false, false};
        for (char c : axes) {
            const std::size_t axis = std::string_view("xyz").find(c);
            if (axis == std::string_view::npos || along[axis]) axes.clear();
            if (axes.empty()) break;
            along[axis] = true;
        }
        if (axes.empty()) {
            table.mistake("along",
                          "along must name axes of the work frame, each once: \"xyz\" clamps, "
                          "\"y\" is a smooth plane across y");
        }
    }

    void read_load(const Node& node, MachineSpec& machine) {
        TableReader table(node, "[[load]]", reading_);
        LoadSpec load;
        load.name = read_name(table, {});
        read_load_keys(table, expression_, load);
        table.finish();
        machine.load.push_back(std::move(load));
    }

    void read_edge(TableReader& table, ExpressionReader& expression, BladeSpec& blade) {
        table.describe("edge", "points, each [x, y, z] of expressions");
        const Node* edge = table.find("edge");
        const bool is_curve =
            edge != nullptr && edge->kind == Node::Kind::array && edge->item.size() == 3 &&
            std::ranges::none_of(edge->item,
                                 [](const Node& one) { return one.kind == Node::Kind::array; });
        if (edge == nullptr) {
            table.missing("edge", "at least two points, such as [[0, 0, -1], [0, 0, 1]]");
        } else if (is_curve) {
            ExpressionReader curved = expression.curved();
            curved.read_item(table, "edge", *edge, Quantity::length, blade.edge.emplace_back());
            expression.take_used(curved);
            if (mistakes_.is_clean() && !curved.is_used(kAlong)) {
                table.mistake("edge",
                              "a single point is no edge: give two, or let it change with `along`");
            }
        } else if (edge->kind != Node::Kind::array || edge->item.size() < 2) {
            table.mistake("edge", "edge must be at least two points, each of three numbers");
        } else {
            for (const Node& point : edge->item) {
                blade.edge.emplace_back();
                expression.read_item(table, "edge", point, Quantity::length, blade.edge.back());
            }
            if (mistakes_.is_clean() && blade.edge.size() < 4 &&
                blade.edge.front() == blade.edge.back()) {
                table.mistake("edge", "edge begins and ends at the same point");
            }
        }
        const bool says_points = table.whole("points", 2, 1000, blade.points);
        if (says_points && edge != nullptr && !is_curve) {
            table.warn("points", "points has no effect: this edge is given by its points");
        }
    }

    void read_blade(const Node& node, MachineSpec& machine) {
        TableReader table(node, "[[blade]]", reading_);
        BladeSpec blade;
        ExpressionReader expression = read_repeat(table, blade.repeat);
        blade.name = read_name(table, blade.repeat);
        read_edge(table, expression, blade);
        if (expression.read(table, "thickness", Quantity::length, blade.thickness)) {
            expression.expect_positive(table, "thickness");
        }
        read_motion(table, "[blade.motion]", expression, blade.motion, false);
        table.finish();
        machine.blade.push_back(std::move(blade));
    }

    void read_check(const Node& node, MachineSpec& machine) {
        TableReader table(node, "[[check]]", reading_);
        CheckSpec check;
        if (!expression_.read(table, "holds", check.holds)) {
            table.missing("holds", "a condition, such as \"radius < length\"");
        }
        if (!table.text("otherwise", check.otherwise)) {
            table.missing("otherwise", "the message to the user if it does not hold");
        }
        table.finish();
        machine.check.push_back(std::move(check));
    }

    void warn_of_unused(const Node& root) {
        const Entry* all = root.find("parameter");
        if (all == nullptr || !mistakes_.is_clean()) return;
        for (const Entry& entry : all->value.entry) {
            if (expression_.is_used(entry.key)) continue;
            mistakes_.warn(entry.place,
                           fmt::format("no expression uses the parameter \"{}\"", entry.key));
        }
    }

    fs::path folder_;
    MistakeList& mistakes_;
    Reading& reading_;
    struct Part {
        std::string name;
        Place place;
        bool is_repeated;
    };

    ExpressionReader expression_;
    ExpressionReader counting_;  // sees what is known before the work-piece
    std::set<std::string> part_names_;
    std::vector<Part> parts_;
};

}  // namespace

void read_machine_document(const Document& document, const fs::path& folder, Reading& reading,
                           MachineSpec& machine) {
    MachineReader(folder, reading).read(document, machine);
}

MachineReading read_machine(const fs::path& file) {
    std::error_code error;
    const fs::path absolute = fs::absolute(file, error).lexically_normal();
    const fs::path shown = shown_path(file);
    MachineReading result;
    MistakeList mistakes;
    if (const auto document = read_document(file, shown, mistakes)) {
        MachineSpec machine;
        machine.name = file.stem().string();
        machine.file = absolute;
        Reading reading(mistakes);
        read_machine_document(*document, absolute.parent_path(), reading, machine);
        if (mistakes.is_clean()) result.machine = std::move(machine);
    }
    result.mistakes = mistakes.take(shown);
    return result;
}

}  // namespace swage
