// SPDX-License-Identifier: GPL-3.0-or-later
// How stages' machines stand at the work-piece, and what of its surface their loads act on.
#pragma once

#include <string>
#include <vector>

#include "machines/machine.h"
#include "pipeline/json.h"
#include "scene/spec.h"

namespace swage {

// "the machine's x, y, z are the world's y, z, x"; empty where they are the same.
std::string axes_text(const WorkFrame& frame);
Json axes_json(const WorkFrame& frame);  // ["y", "z", "x"]

// For each load: how much it acts on, in which parts, and where their middles are, by the machine's
// axes from the middle of the work-piece's box, as the load's own `from` and `to`; in JSON by the
// world's too.
std::vector<std::string> load_texts(const Machine& machine);
Json loads_json(const Machine& machine);  // and what they push with where they act the most
// For each load what it pushes with where its strength is the most, and which way in the world.
std::vector<std::string> push_texts(const Machine& machine);

// Of a stage before the run; of any but the first, as if the work-piece came to it as it is now.
// Empty and null where the machine cannot be set up so.
struct MachinePlace {
    std::string stage;
    std::string axes{};               // as axes_text()
    std::vector<std::string> load{};  // as load_texts()
    Json axes_json{}, loads_json{};
    std::vector<std::string> limit{};  // as limit_texts()
    Json limits_json{};
    std::string tools{};              // as tools_text()
    std::vector<std::string> note{};  // Machine::notes
    std::vector<std::string> push{};  // as push_texts()
};

// From which side of the world the tools come that are moved to the work-piece, and what sets that;
// empty: not all from one side, or none.
std::string tools_text(const StageSpec& stage, const WorkFrame& frame);

// Of all stages. `first`: the machine of the first. `coarser`: as build_machine() has it.
std::vector<MachinePlace> machine_places(const SceneSpec& scene, const Machine& first,
                                         const Aggregate& work_piece,
                                         const std::vector<Material>& beside, const Box& skin,
                                         double coarser = 1);

// What the machines of all stages but the first say of the work-piece as it is now, each sentence
// once, with its stages.
std::vector<std::string> later_notes(const std::vector<MachinePlace>& places);

Json places_json(const std::vector<MachinePlace>& places);

}  // namespace swage
