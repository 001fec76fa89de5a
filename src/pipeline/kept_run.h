// SPDX-License-Identifier: GPL-3.0-or-later
// What an earlier run in a directory has left to go on from.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/checkpoint.h"
#include "pipeline/run_directory.h"
#include "pipeline/stage_mark.h"
#include "scene/spec.h"

namespace swage {

struct KeptRun {
    std::optional<Reached> reached;  // none: no stage is finished
    std::optional<StageMark> mark;   // within the stage after those
    std::filesystem::path motion;    // which holds its motion
};

// After as many stages as can be; what is not whole is told of. Throws Error(foreign) where a run
// that is to go on from stages that are the same has none.
std::optional<KeptRun> kept_by_earlier_run(const SceneSpec& scene, const RunDirectory& directory);

// What was kept within a stage serves nothing once the run is done. Its stages stay.
void forget_what_is_within(const RunDirectory& directory);

}  // namespace swage
