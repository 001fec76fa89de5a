// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/failure.h"
#include "base/hash.h"
#include "base/log.h"
#include "pipeline/cost.h"
#include "pipeline/disk_reserve.h"
#include "pipeline/draw.h"
#include "pipeline/frame_store.h"
#include "pipeline/interrupt.h"
#include "pipeline/plot.h"
#include "pipeline/run_record.h"
#include "pipeline/stage.h"
#include "pipeline/start_warnings.h"

namespace swage {

namespace {

FrameRange wanted_frames(const SceneSpec& scene, const RunOptions& options) {
    const int last = frame_count(scene);
    const FrameRange wanted = options.frames.value_or(FrameRange{1, last});
    refuse_frames_beyond(last, wanted);
    return wanted;
}

// Throws Error(output) where what is to be gone on from has been damaged.
bool is_simulated(const Json& record, const SceneSpec& scene, const RunDirectory& directory) {
    const Json& state = record.at("state");
    if ((state != RunState::simulated && state != RunState::complete) ||
        !std::filesystem::exists(directory.store())) {
        return false;
    }
    const Json frames = record.value("frames", Json());
    const Json seconds = record.value("seconds", Json::object());
    if (!frames.is_number_integer() || frames < 1 || frames > frame_count(scene) ||
        !seconds.is_object()) {
        fail(ExitCode::output, "{}: is damaged; --fresh throws that run away",
             directory.record().string());
    }
    return true;
}

// What run.json may need beside what it holds already: times, warnings, and each stage's books.
constexpr std::uint64_t kRecordRoom = 64 << 10, kStageRecordRoom = 16 << 10;

void write_record(const RunDirectory& directory, Json& record, const Stopwatch& watch) {
    // What is drawn later leaves what the simulation took.
    record["seconds"].update(seconds_json(watch));
    write_file_whole(directory.record(), json_text(record));
}

// What ended a simulation before its time.
struct Ended {
    std::optional<Error> stopped;
    std::optional<Interrupted> interrupted;
    bool early() const { return stopped || interrupted; }
};

// All stages; the motion file and run.json stand when it returns. `at_start`: what can be said
// before anything is molded.
Ended simulate(const SceneSpec& scene, const std::vector<InputMesh>& input, StartWarnings at_start,
               RunDirectory& directory, Json& record, Stopwatch& watch) {
    const bool can_plot = gnuplot_is_present();
    if (!can_plot) {
        log_warning(
            "no program gnuplot was found, so the curves are not plotted "
            "(apt-get install gnuplot-nox)");
    }
    std::vector<WorkPiece> bodies;
    for (std::size_t b = 0; b < input.size(); ++b) {
        {
            const auto lap = watch.lap("mold");
            bodies.push_back(make_work_piece(input[b], scene.body[b], scene.skin));
        }
        for (const std::string& warning :
             warnings_of_mold(bodies[b].name, input.size() > 1, bodies[b].finding)) {
            log_warning("{}", warning);
            at_start.mold.push_back(warning);
        }
        const Aggregate& matter = bodies[b].matter;
        record["bodies"][b]["matter"] = matter_json(matter);
        log_info("{}: {} cells of {:.4g} mm, {} particles, {} connections, {:.4g} kg",
                 input.size() == 1 ? "molded" : "molded " + bodies[b].name, matter.cell_fill.size(),
                 1e3 * matter.lattice.spacing, matter.particle_count(), matter.connection_count(),
                 matter.mass());
    }
    at_start.bodies = warnings_of_bodies(scene, named(bodies));
    for (const auto* untold : {&at_start.strength, &at_start.bodies}) {
        for (const std::string& warning : *untold) log_warning("{}", warning);
    }
    std::vector<std::string> warnings = at_start.all();

    MotionRecorder recorder(directory.store());
    Progress progress("simulate", frame_count(scene) - 1);
    Ended ended;
    long steps = 0;
    DiskReserve reserve;
    const auto begin = [&] {
        directory.begin();
        reserve.hold(directory.root(), 2 * json_text(record).size() + kRecordRoom +
                                           kStageRecordRoom * scene.stage.size());
        make_folder(directory.root() / "meshes");
        make_folder(directory.root() / "curves");
    };
    for (const StageSpec& stage : scene.stage) {
        const StageContext context{scene, directory.root(), recorder, watch, progress,
                                   begin, can_plot};
        try {
            throw_if_interrupted();
            StageOutcome outcome = run_stage(stage, recorder.frame_count(), bodies, context);
            record["stages"].push_back(outcome.record);
            steps += outcome.steps;
            warnings.insert(warnings.end(), outcome.warning.begin(), outcome.warning.end());
            ended = {outcome.stopped, outcome.interrupted};
        } catch (const Interrupted& interrupted) {
            // While the stage was set up.
            if (recorder.frame_count() == 0) throw;
            ended.interrupted = interrupted;
        } catch (const std::exception& error) {
            // A stage that cannot be set up at what those before have made, or written, or that
            // wants for memory.
            ended.stopped = failure_of(error);
            if (recorder.frame_count() == 0 || !ended.stopped) throw;
        }
        if (ended.early()) break;
    }
    reserve.release();
    recorder.finish();
    record["frames"] = recorder.frame_count();
    record["steps"] = steps;
    record["state_hash"] = hash_text(state_hash(bodies));
    record["warnings"] = warnings;
    record["state"] = ended.interrupted ? RunState::interrupted
                      : ended.stopped   ? RunState::stopped
                                        : RunState::simulated;
    if (ended.stopped) record["stopped"] = ended.stopped->what();
    write_record(directory, record, watch);
    return ended;
}

}  // namespace

RunOutcome run_scene(const SceneSpec& scene, const RunOptions& options) {
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
        !options.fresh && std::filesystem::exists(options.out / "run.json", unknown);
    if (!may_be_done) refuse_early();
    RunDirectory directory(options.out, identity, options.fresh);
    const DrawnFiles files{directory.root()};

    RunOutcome outcome;
    const std::optional<Json> earlier =
        may_be_done ? read_record(directory.record()) : std::nullopt;
    const bool simulated = earlier && is_simulated(*earlier, scene, directory);
    if (simulated && (!options.draw || is_drawn(*earlier, files, wanted, scene.render.film))) {
        log_info("{}: already complete", directory.root().string());
        outcome.record = *earlier;
        outcome.was_complete = true;
        return outcome;
    }
    if (may_be_done) refuse_early();
    throw_if_interrupted();

    Ended ended;
    if (simulated) {
        log_info("{}: already simulated", directory.root().string());
        outcome.record = *earlier;
    } else {
        outcome.record = begin_record(scene, options, identity, input);
        ended = simulate(scene, input, cost.warning, directory, outcome.record, watch);
    }
    const int reached = outcome.record.at("frames").get<int>();
    if (ended.interrupted) {
        log_text(fmt::format("{} of {} frames are finished; swage render {} draws them", reached,
                             frame_count(scene), directory.root().string()));
        throw *ended.interrupted;
    }
    const auto draw = [&] {
        if (!options.draw || wanted.first > reached) return;
        const FrameStore store(directory.store());
        const FrameRange drawn{wanted.first, std::min(wanted.last, reached)};
        outcome.record["drawing"] =
            drawing_json(draw_run(store, scene.render, drawn, files, watch));
    };
    if (ended.stopped) {
        // What ended the run is its outcome, whether that can be drawn and told or not.
        try {
            draw();
            write_record(directory, outcome.record, watch);
        } catch (const std::exception& error) {
            const std::optional<Error> failure = failure_of(error);
            if (!failure) throw;
            log_warning("{}", failure->what());
        }
        throw *ended.stopped;
    }
    draw();
    outcome.record["state"] = RunState::complete;
    write_record(directory, outcome.record, watch);
    log_info("{}: done", directory.root().string());
    return outcome;
}

}  // namespace swage
