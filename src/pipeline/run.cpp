// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.h"

#include <algorithm>

#include "base/failure.h"
#include "base/log.h"
#include "pipeline/bend_watch.h"
#include "pipeline/cost.h"
#include "pipeline/draw.h"
#include "pipeline/frame_store.h"
#include "pipeline/free_room.h"
#include "pipeline/kept_run.h"
#include "pipeline/run_record.h"
#include "pipeline/scene_identity.h"
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

// One execution of a scene: what an earlier one in the same directory has not done yet is
// simulated, plotted and drawn.
class SceneRun {
  public:
    SceneRun(const SceneSpec& scene, const RunOptions& options)
        : scene_(scene),
          options_(options),
          wanted_(wanted_frames(scene, options)),
          input_(read_input()),
          cost_(estimate_cost(scene, input_, options)),
          identity_(identity_of(scene, input_, options)),
          may_be_done_(options.earlier != EarlierRun::replace && has_record()),
          directory_(enter()),
          files_{directory_.root(), scene.render.first_frame},
          plots_(plots_of(scene, directory_)) {}

    Json run() {
        try {
            return go_through();
        } catch (const InterruptedRun&) {
            throw;
        } catch (const Interrupted& interrupted) {
            // What is simulated has its record, however little of it is drawn.
            if (record_.empty() || !is_simulated(record_)) throw;
            throw InterruptedRun(interrupted, std::move(record_));
        }
    }

  private:
    Json go_through() {
        is_simulated_ = take_up_earlier();
        if (is_simulated_) {
            forget_what_is_within(directory_);
            if (plots_.has_undrawn() || !record_.contains("plots")) draw_plots();
            if (!options_.draw || is_drawn(record_, files_, wanted_, scene_.render)) {
                return tell_that_it_is_done();
            }
        }
        if (may_be_done_) refuse_early();
        throw_if_interrupted();
        const Ended ended = simulate_unless_done();
        if (ended.interrupted) leave(*ended.interrupted);
        if (ended.stopped) end_stopped(*ended.stopped);
        draw();
        return complete();
    }

    std::vector<InputMesh> read_input() {
        const auto lap = watch_.lap("read");
        return read_input_meshes(scene_);
    }

    bool has_record() const {
        std::error_code unknown;
        return std::filesystem::exists(RunDirectory::record_in(options_.out), unknown);
    }

    void refuse_early() const {
        refuse_excess(cost_, options_);
        if (options_.draw) check_drawing(scene_.render);
    }

    // Where nothing can have been done yet, nothing is made before it is known to be worth it.
    RunDirectory enter() const {
        if (!may_be_done_) refuse_early();
        return RunDirectory(options_.out, identity_, options_.earlier);
    }

    // Whether all of its stages are done already.
    bool take_up_earlier() {
        if (!may_be_done_ || directory_.is_changed()) return false;
        std::optional<Json> earlier = read_record(directory_.record());
        if (!earlier || !stands(*earlier, scene_, directory_)) return false;
        record_ = std::move(*earlier);
        return true;
    }

    // The one before may have ended before it could say so.
    Json tell_that_it_is_done() {
        const bool is_complete = record_.at("state") == RunState::complete;
        if (!is_complete) {
            record_["state"] = RunState::complete;
            write_record(directory_, record_, watch_);
        }
        directory_.remove_replaced();
        log_info("{}: {}", directory_.root().string(),
                 is_complete || options_.draw
                     ? "already complete"
                     : "already simulated; nothing is drawn because of --no-render");
        return std::move(record_);
    }

    Ended simulate_unless_done() {
        if (is_simulated_) {
            log_info("{}: already simulated", directory_.root().string());
            return {};
        }
        record_ = begin_record(scene_, options_, identity_, input_);
        return simulate({scene_, input_, directory_, plots_, record_, watch_, options_.keep_every},
                        cost_.warning);
    }

    int reached() const { return record_.at("frames").get<int>(); }

    [[noreturn]] void leave(const Interrupted& interrupted) {
        log_text(fmt::format("{} of {} frames are finished; swage render {} draws them", reached(),
                             frame_count(scene_), directory_.root().string()));
        throw InterruptedRun(interrupted, std::move(record_));
    }

    // What ended the run is its outcome, whether that can be drawn and told or not.
    [[noreturn]] void end_stopped(const Error& stopped) {
        tell_use();
        try {
            draw();
            write_record(directory_, record_, watch_);
        } catch (const Interrupted& interrupted) {
            log_text(interrupted.what());
        } catch (const std::exception& error) {
            const std::optional<Error> failure = failure_of(error);
            if (!failure) throw;
            log_warning("{}", failure->what());
        }
        throw StoppedRun(stopped, std::move(record_));
    }

    // What may fail, and is no loss, comes after everything else of the simulation.
    void draw_plots() {
        const auto lap = watch_.lap("plot");
        plots_.draw();
        record_["plots"]["warnings"] = plots_.warnings();
        write_record(directory_, record_, watch_);
        throw_if_interrupted();
    }

    void draw() {
        if (!is_simulated_) draw_plots();
        if (!options_.draw || wanted_.first > reached()) return;
        give_back_memory();
        const FrameStore store(directory_.store());
        const FrameRange drawn{wanted_.first, std::min(wanted_.last, reached())};
        record_["drawing"] = drawing_json(
            draw_run(store, scene_.render, drawn, files_, watch_, run_names_of(record_)));
    }

    void tell_use() const {
        for (const Json& stage : record_.at("stages")) {
            if (const std::string bent = bend_text(stage); !bent.empty()) log_info("{}", bent);
            for (const std::string& text : use_texts(stage)) log_info("{}", text);
        }
    }

    Json complete() {
        record_["state"] = RunState::complete;
        write_record(directory_, record_, watch_);
        directory_.remove_replaced();
        tell_use();
        log_info("{}: done", directory_.root().string());
        return std::move(record_);
    }

    const SceneSpec& scene_;
    const RunOptions& options_;
    Stopwatch watch_;
    const FrameRange wanted_;
    const std::vector<InputMesh> input_;
    const RunCost cost_;
    const RunIdentity identity_;
    const bool may_be_done_;  // there is a record
    RunDirectory directory_;
    const DrawnFiles files_;
    Plots plots_;
    Json record_;
    bool is_simulated_ = false;  // by an earlier one
};

}  // namespace

Json run_scene(const SceneSpec& scene, const RunOptions& options) {
    return SceneRun(scene, options).run();
}

}  // namespace swage
