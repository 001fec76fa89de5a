// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_probe.h"

#include <algorithm>

#include "base/text.h"
#include "scene/read_fields.h"
#include "scene/read_load.h"

namespace swage {

void read_probe(TableReader& table, std::set<std::string>& names, SceneSpec& scene) {
    ProbeSpec probe;
    probe.name = read_part_name(table, names);
    if (!table.vector("at", Quantity::number, probe.at)) {
        table.missing("at", "a place in fractions of the body's box, such as [1, 0.5, 0.5]");
    } else if ((probe.at.array() < 0).any() || (probe.at.array() > 1).any()) {
        table.mistake(
            "at", fmt::format(
                      "at = [{:g}, {:g}, {:g}]: each must be a fraction of the body's box, 0 to 1",
                      probe.at.x(), probe.at.y(), probe.at.z()));
    }
    const Node* at = table.find("at");
    probe.place = at != nullptr ? at->place : table.place();
    read_fields(table, probe.fields);
    std::string of = scene.work_piece().name;
    table.text("body", of);
    const auto body = std::find_if(scene.body.begin(), scene.body.end(),
                                   [&](const BodySpec& one) { return one.name == of; });
    if (body != scene.body.end()) {
        body->probe.push_back(std::move(probe));
    } else {
        std::vector<std::string> known;
        for (const BodySpec& one : scene.body) known.push_back(one.name);
        table.mistake(
            "body", fmt::format("no body is called \"{}\"; there is {}", of, joined(known, ", ")));
    }
    table.finish();
}

void refuse_probes_named_as_parts(TableReader& root, const SceneSpec& scene) {
    std::set<std::string> parts;
    for (const StageSpec& stage : scene.stage) {
        for (const auto& tool : stage.machine.tool) parts.insert(tool.name);
        for (const auto& grip : stage.machine.grip) parts.insert(grip.name);
        for (const auto& blade : stage.machine.blade) parts.insert(blade.name);
        for (const auto& load : stage.machine.load) parts.insert(load.name);
    }
    for (const BodySpec& body : scene.body) {
        for (const ProbeSpec& probe : body.probe) {
            if (!parts.contains(probe.name)) continue;
            root.mistake(
                "probe",
                fmt::format(
                    "\"{}\" is a part of a machine, listed in the same table: choose another name",
                    probe.name));
        }
    }
}

}  // namespace swage
