// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of a run, one after another, from the first or from where an earlier run of the same
// scene in the same directory got to.
#pragma once

#include <optional>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/stopwatch.h"
#include "pipeline/json.h"
#include "pipeline/plot.h"
#include "pipeline/run_directory.h"
#include "pipeline/start_warnings.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

// What ended a simulation before its time.
struct Ended {
    std::optional<Error> stopped;
    std::optional<Interrupted> interrupted;
    bool early() const { return stopped || interrupted; }
};

struct SimulationContext {
    const SceneSpec& scene;
    const std::vector<InputMesh>& input;
    RunDirectory& directory;
    Plots& plots;
    Json& record;  // begin_record's
    Stopwatch& watch;
    std::optional<double> keep_every;  // as StageKeeper takes it
};

// The motion file and run.json stand when it returns, and the plots of all stages but the last that
// it did are tried. `at_start`: what can be said before anything is molded.
Ended simulate(const SimulationContext& context, StartWarnings at_start);

}  // namespace swage
