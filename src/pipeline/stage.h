// SPDX-License-Identifier: GPL-3.0-or-later
// One stage of a run: the machine is set up at the work-piece as it is, works on it frame by frame,
// and what it did is written down.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/stopwatch.h"
#include "pipeline/json.h"
#include "pipeline/motion_recorder.h"
#include "pipeline/stage_keeper.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

struct StageContext {
    const SceneSpec& scene;
    std::filesystem::path root;  // of the run directory
    MotionRecorder& recorder;
    Stopwatch& watch;
    Progress& progress;
    std::function<void()> begin;  // called once a stage is set up, before its first frame
    StageKeeper& keeper;
    StageMark* from = nullptr;  // within the stage, where it goes on; null: it begins
    // That the stage before has handed on (Simulation::hand_on()); afterwards, of one that is done,
    // its own.
    std::string& contacts;
};

struct StageOutcome {
    Json record;  // for run.json
    long steps = 0;
    std::vector<std::string> warning;  // all told already
    // The simulation gave up, the disk was full, or somebody asked for it; what was reached is
    // kept.
    std::optional<Error> stopped;
    std::optional<Interrupted> interrupted;
};

// `last_frame`: the number of the last frame before the stage, 0 for the first stage, which then
// also records frame 1, the untouched start. The bodies are as the stage begins, wherever it goes
// on from.
// The first of the bodies is the work-piece, which the machine is set up at.
StageOutcome run_stage(const StageSpec& stage, int last_frame, std::vector<WorkPiece>& bodies,
                       const StageContext& context);

}  // namespace swage
