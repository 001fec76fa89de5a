// SPDX-License-Identifier: GPL-3.0-or-later
// One execution of a scene, from the mesh to the film.
#pragma once

#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "pipeline/json.h"
#include "pipeline/run_directory.h"
#include "pipeline/run_options.h"
#include "scene/spec.h"

namespace swage {

// What ended a run on its way, with what run.json holds of it.
struct StoppedRun : Error {
    StoppedRun(const Error& why, Json ended) : Error(why), record(std::move(ended)) {}
    Json record;
};

// The same where somebody asked it to end and run.json is written.
struct InterruptedRun : Interrupted {
    InterruptedRun(const Interrupted& why, Json ended)
        : Interrupted(why), record(std::move(ended)) {}
    Json record;
};

// Returns what run.json holds. Throws Error (see base/error.h for the codes) and Interrupted; the
// files that exist are whole. When the simulation gives up, what was reached is written and drawn
// before StoppedRun.
Json run_scene(const SceneSpec& scene, const RunOptions& options);

}  // namespace swage
