// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_limit.h"

#include <algorithm>

#include "base/suggest.h"
#include "base/text.h"
#include "machines/machine_spec.h"
#include "scene/expressions.h"
#include "sim/settings.h"

namespace swage {

namespace {

template <typename Keep>
std::vector<std::string> parts_of(const MachineSpec& machine, const Keep& keep) {
    std::vector<std::string> names;
    for (const ToolSpec& tool : machine.tool) {
        if (keep(tool.motion)) names.push_back(tool.name);
    }
    for (const GripSpec& grip : machine.grip) {
        if (keep(grip.motion)) names.push_back(grip.name);
    }
    return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// `stops`: the machine can; else that is what is wrong, whatever the part.
void read_part(TableReader& table, const MachineSpec& machine, bool stops, LimitSpec& limit) {
    const std::vector<std::string> parts =
        parts_of(machine, [](const MotionSpec&) { return true; });
    const std::string known = parts.empty() ? "none" : joined(parts, ", ");
    if (!table.text("part", limit.part)) {
        table.missing("part", "a tool or grip of the machine: " + known);
        return;
    }
    if (contains(parts, limit.part)) return;
    if (stops) {
        table.mistake(
            "part", fmt::format("machine {} has no tool or grip \"{}\"{}", machine.name, limit.part,
                                hint_and(did_you_mean(limit.part, parts), "it has " + known)));
    }
    limit.part.clear();
}

void read_most(TableReader& table, const MachineSpec& machine, LimitSpec& limit) {
    double force = 0, torque = 0;
    const bool has_force = table.quantity("force", Quantity::force, above(0), force);
    limit.of_torque = table.quantity("torque", Quantity::torque, above(0), torque);
    limit.most = has_force ? force : torque;
    if (has_force && limit.of_torque) {
        table.mistake("torque", "a limit is a force or a torque: give one of them");
    } else if (!has_force && !limit.of_torque) {
        table.missing("force", "such as \"20 kN\"; or torque, such as \"500 N m\"");
    } else if (limit.of_torque && !limit.part.empty()) {
        const std::vector<std::string> turning =
            parts_of(machine, [](const MotionSpec& motion) { return motion.turn != "0"; });
        if (contains(turning, limit.part)) return;
        table.mistake("torque",
                      fmt::format("{} does not rotate, so its torque has no axis: {}", limit.part,
                                  turning.empty() ? "no part of this machine does; limit a force"
                                                  : "limit its force, or the torque of " +
                                                        joined(turning, ", ")));
    }
}

}  // namespace

void read_limits(TableReader& stage, Solver solver, MachineSpec& machine) {
    for (const Node* node : stage.tables("limit", "[[stage.limit]]")) {
        TableReader table(*node, "[[stage.limit]]", stage.reading());
        const bool describes = stage.reading().describes;
        LimitSpec limit;
        limit.place = text_place(node->place);
        MistakeList& mistakes = stage.reading().mistakes;
        const bool stops = !in_motion(solver) && machine.stops;
        if (in_motion(solver) && !describes) {
            mistakes.add(
                node->place,
                fmt::format("a limit needs equilibria: with solver = \"{}\" forces oscillate, and "
                            "no machine can stop at one; choose solver = \"quasistatic\"",
                            name_of(solver)));
        } else if (!machine.stops && !describes) {
            mistakes.add(node->place,
                         fmt::format("no motion of machine {} can stop early: one that can uses "
                                     "the variable {} (`swage keys --machine`), as in min(t, {})",
                                     machine.name, kStop, kStop));
        }
        read_part(table, machine, stops || describes, limit);
        read_most(table, machine, limit);
        table.finish();
        machine.limit.push_back(std::move(limit));
    }
}

}  // namespace swage
