// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.h"

#include <algorithm>

#include "base/failure.h"
#include "base/log.h"
#include "pipeline/cost.h"
#include "pipeline/draw.h"
#include "pipeline/frame_store.h"
#include "pipeline/kept_run.h"
#include "pipeline/run_record.h"
#include "pipeline/signals.h"
#include "pipeline/simulate.h"
#include "pipeline/stage_products.h"
#include "pipeline/use_watch.h"

namespace swage {

namespace {

FrameRange wanted_frames(const SceneSpec& scene, const RunOptions& options) {
    const int last = frame_count(scene);
    const FrameRange wanted = options.frames.value_or(FrameRange{1, last});
    refuse_frames_beyond(last, wanted, scene.render.first_frame);
    return wanted;
}

// Throws Error(output) where what is to be gone on from has been damaged.
bool stands(const Json& record, const SceneSpec& scene, const RunDirectory& directory) {
    if (!is_simulated(record) || !std::filesystem::exists(directory.store())) return false;
    const Json frames = record.value("frames", Json());
    const Json seconds = record.value("seconds", Json::object());
    const Json plots = record.value("plots", Json::object());
    if (!frames.is_number_integer() || frames < 1 || frames > frame_count(scene) ||
        !seconds.is_object() || !plots.is_object() || !record.value("stages", Json()).is_array()) {
        fail(ExitCode::output, "{}: is damaged; --fresh throws that run away",
             directory.record().string());
    }
    try {
        const FrameStore whole(directory.store());
    } catch (const Error& error) {
        log_warning("{}", error.what());  // how much of it can be gone on from is told then
        return false;
    }
    const std::filesystem::path missing =
        missing_product(scene, directory, static_cast<int>(scene.stage.size()));
    if (!missing.empty()) {
        fail(ExitCode::output, "{}: is gone; --fresh makes all of the run anew", missing.string());
    }
    return true;
}

Plots plots_of(const SceneSpec& scene, const RunDirectory& directory) {
    std::vector<std::string> names;
    for (const StageSpec& stage : scene.stage) names.push_back(stage.name);
    return {directory.root() / "curves", names};
}

}  // namespace

Json run_scene(const SceneSpec& scene, const RunOptions& options) {
    Stopwatch watch;
    const FrameRange wanted = wanted_frames(scene, options);
    std::vector<InputMesh> input;
    {
        const auto lap = watch.lap("read");
        input = read_input_meshes(scene);
    }
    const RunCost cost = estimate_cost(scene, input, options);
    const RunIdentity identity = identity_of(scene, input, options);
    const auto refuse_early = [&] {
        refuse_excess(cost, options);
        if (options.draw) check_drawing(scene.render);
    };
    // Where nothing can have been done yet, nothing is made before it is known to be worth it.
    std::error_code unknown;
    const bool may_be_done =
        !options.fresh && std::filesystem::exists(RunDirectory::record_in(options.out), unknown);
    if (!may_be_done) refuse_early();
    RunDirectory directory(options.out, identity, options.fresh, options.go_on);
    const DrawnFiles files{directory.root(), scene.render.first_frame};

    Json record;
    const std::optional<Json> earlier =
        may_be_done && !directory.is_changed() ? read_record(directory.record()) : std::nullopt;
    const bool simulated = earlier && stands(*earlier, scene, directory);
    // What may fail, and is no loss, comes after everything else of the simulation.
    Plots plots = plots_of(scene, directory);
    const auto draw_plots = [&] {
        const auto lap = watch.lap("plot");
        plots.draw();
        record["plots"]["warnings"] = plots.warnings();
        write_record(directory, record, watch);
        throw_if_interrupted();
    };
    if (simulated) {
        forget_what_is_done(directory, scene);
        record = *earlier;
        if (plots.has_undrawn()) draw_plots();
        if (!options.draw || is_drawn(record, files, wanted, scene.render)) {
            if (record.at("state") == RunState::complete) directory.remove_replaced();
            log_info("{}: {}", directory.root().string(),
                     record.at("state") == RunState::complete
                         ? "already complete"
                         : "already simulated; nothing is drawn because of --no-render");
            return record;
        }
    }
    if (may_be_done) refuse_early();
    throw_if_interrupted();

    Ended ended;
    if (simulated) {
        log_info("{}: already simulated", directory.root().string());
    } else {
        record = begin_record(scene, options, identity, input);
        ended = simulate({scene, input, directory, plots, record, watch, options.keep_every},
                         cost.warning);
    }
    const int reached = record.at("frames").get<int>();
    if (ended.interrupted) {
        log_text(fmt::format("{} of {} frames are finished; swage render {} draws them", reached,
                             frame_count(scene), directory.root().string()));
        throw *ended.interrupted;
    }
    const auto draw = [&] {
        if (!simulated) draw_plots();
        if (!options.draw || wanted.first > reached) return;
        const FrameStore store(directory.store());
        const FrameRange drawn{wanted.first, std::min(wanted.last, reached)};
        record["drawing"] =
            drawing_json(draw_run(store, scene.render, drawn, files, watch, run_names_of(record)));
    };
    const auto tell_use = [&] {
        for (const Json& stage : record.at("stages")) {
            for (const std::string& text : use_texts(stage)) log_info("{}", text);
        }
    };
    if (ended.stopped) {
        tell_use();
        // What ended the run is its outcome, whether that can be drawn and told or not.
        try {
            draw();
            write_record(directory, record, watch);
        } catch (const std::exception& error) {
            const std::optional<Error> failure = failure_of(error);
            if (!failure) throw;
            log_warning("{}", failure->what());
        }
        throw StoppedRun(*ended.stopped, std::move(record));
    }
    draw();
    record["state"] = RunState::complete;
    write_record(directory, record, watch);
    directory.remove_replaced();
    tell_use();
    log_info("{}: done", directory.root().string());
    return record;
}

}  // namespace swage
