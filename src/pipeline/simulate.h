// SPDX-License-Identifier: GPL-3.0-or-later
// The stages of a run, one after another, from the first or from where an earlier run of the same
// scene in the same directory got to.
#pragma once

#include <filesystem>
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

// A mesh or a table of the first stages that is not there any more; empty: all are.
std::filesystem::path missing_product(const SceneSpec& scene, const RunDirectory& directory,
                                      int stages);

// What a run that is done leaves to go on from: its stages, unless the scene wants none.
void forget_what_is_done(const RunDirectory& directory, const SceneSpec& scene);

// The motion file and run.json stand when it returns, and the plots of all stages but the last that
// it did are tried. `record`: begin_record's. `at_start`: what can be said before anything is
// molded. `keep_every`: as StageKeeper takes it.
Ended simulate(const SceneSpec& scene, const std::vector<InputMesh>& input, StartWarnings at_start,
               RunDirectory& directory, Plots& plots, Json& record, Stopwatch& watch,
               std::optional<double> keep_every);

}  // namespace swage
