// SPDX-License-Identifier: GPL-3.0-or-later
// What run.json says of a run.
#pragma once

#include <optional>

#include "base/stopwatch.h"
#include "pipeline/draw.h"
#include "pipeline/json.h"
#include "pipeline/run_directory.h"
#include "pipeline/run_options.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

// How far a run has come: "state" in run.json.
enum class RunState { begun, simulated, complete, stopped, interrupted };
NLOHMANN_JSON_SERIALIZE_ENUM(RunState, {{RunState::begun, "begun"},
                                        {RunState::simulated, "simulated"},
                                        {RunState::complete, "complete"},
                                        {RunState::stopped, "stopped"},
                                        {RunState::interrupted, "interrupted"}})

// Whether all of its stages are done, as it says.
bool is_simulated(const Json& record);

// The parts of run.json that are known before the first stage.
Json begin_record(const SceneSpec& scene, const RunOptions& options, const RunIdentity& identity,
                  const std::vector<InputMesh>& input);
Json mesh_json(const InputMesh& input);
Json matter_json(const Aggregate& matter);
Json drawing_json(const DrawOutcome& drawing);
Json seconds_json(const Stopwatch& watch);

// What it warns of in all of its lists: of the scene and the stages, of plots, of pictures. Throws
// Json::exception where it is damaged.
std::vector<std::string> warnings_in(const Json& record);

// Writes it as it is, with the seconds spent; what is drawn later leaves what the simulation took.
void write_record(const RunDirectory& directory, Json& record, const Stopwatch& watch);

// An earlier record; none when there is none, or no whole one. Throws Error(output) where something
// else has its name.
std::optional<Json> read_record(const std::filesystem::path& file);

// That of a run that was made before. Throws Error(output) where the folder is none.
Json record_of_run(const std::filesystem::path& run);

// Whether the record's pictures include all of these, and they still stand there.
bool is_drawn(const Json& record, const DrawnFiles& files, const FrameRange& frames,
              const RenderSettings& settings);

// Throws Error(output) where it says no bodies and stages.
RunNames run_names_of(const Json& record);

}  // namespace swage
