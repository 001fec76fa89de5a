// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/simulate.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "base/failure.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/progress.h"
#include "pipeline/checkpoint.h"
#include "pipeline/cost.h"
#include "pipeline/disk_reserve.h"
#include "pipeline/kept_run.h"
#include "pipeline/run_record.h"
#include "pipeline/stage.h"
#include "scene/product_names.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// What run.json may need beside what it holds already: times, warnings, and each stage's books.
constexpr std::uint64_t kRecordRoom = 64 << 10, kStageRecordRoom = 16 << 10;

// Everything at its start.
Reached molded(const SceneSpec& scene, const std::vector<InputMesh>& input, StartWarnings at_start,
               Stopwatch& watch) {
    Reached reached;
    std::vector<WorkPiece>& bodies = reached.bodies;
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
        reached.matter.push_back(matter_json(matter));
        log_info("{}: {} cells of {:.4g} mm, {} particles, {} connections, {:.4g} kg",
                 input.size() == 1 ? "molded" : "molded " + bodies[b].name, matter.cell_fill.size(),
                 1e3 * matter.lattice.spacing, matter.particle_count(), matter.connection_count(),
                 matter.mass());
    }
    at_start.bodies = warnings_of_bodies(scene, named(bodies));
    for (const auto* untold : {&at_start.strength, &at_start.bodies}) {
        for (const std::string& warning : *untold) log_warning("{}", warning);
    }
    reached.start_warning = at_start.all();
    return reached;
}

// What the first of them leave in a run directory, but for endings.
std::vector<fs::path> products_of_stages(const SceneSpec& scene, int count) {
    const fs::path meshes = "meshes", curves = "curves";
    std::vector<fs::path> products;
    for (int s = 0; s < count; ++s) {
        const StageSpec& stage = scene.stage[static_cast<std::size_t>(s)];
        for (const std::string& table : table_names(stage)) products.push_back(curves / table);
        for (const BodySpec& body : scene.body) {
            products.push_back(meshes / mesh_name(scene, stage, body));
        }
    }
    return products;
}

// Whether that could be written; the run goes on all the same.
bool keep(const RunDirectory& directory, MotionRecorder& recorder, Stopwatch& watch,
          Reached& reached) {
    const auto lap = watch.lap("write");
    try {
        make_folder(directory.resume());
        recorder.keep(directory.kept_motion());
        reached.motion = recorder.mark();
        reached.skin = recorder.skins();
        reached.seconds = watch.phases();
        write_checkpoint(directory.checkpoint(reached.stages), directory.stage_keys(), reached);
        return true;
    } catch (const std::exception& error) {
        const std::optional<Error> failure = failure_of(error);
        if (!failure) throw;
        log_warning("{}; no run can go on from here", failure->what());
        return false;
    }
}

}  // namespace

fs::path missing_product(const SceneSpec& scene, const RunDirectory& directory, int stages) {
    for (const fs::path& product : products_of_stages(scene, stages)) {
        const bool is_mesh = product.parent_path() == "meshes";
        for (const char* ending : is_mesh ? std::vector{".obj", ".ply"} : std::vector{".csv"}) {
            const fs::path file = directory.root() / fs::path(product).concat(ending);
            std::error_code error;
            if (!fs::exists(file, error)) return file;
        }
    }
    return {};
}

void forget_what_is_done(const RunDirectory& directory, const SceneSpec& scene) {
    if (!scene.output.keep_stages) return directory.forget_kept();
    std::error_code ignored;
    fs::remove(directory.stage_mark(), ignored);
    fs::remove(directory.kept_motion(), ignored);
}

Ended simulate(const SceneSpec& scene, const std::vector<InputMesh>& input, StartWarnings at_start,
               RunDirectory& directory, Plots& plots, Json& record, Stopwatch& watch,
               std::optional<double> keep_every) {
    std::optional<KeptRun> kept = kept_by_earlier_run(scene, directory);
    const MotionMark motion = kept ? kept->motion_mark() : MotionMark{};
    Reached reached;
    if (!kept || !kept->reached || directory.is_changed()) {
        // What is told of the start foresees later stages too.
        reached = molded(scene, input, std::move(at_start), watch);
    }
    if (kept && kept->reached) {
        if (directory.is_changed()) kept->reached->start_warning = std::move(reached.start_warning);
        reached = std::move(*kept->reached);
    }
    StageMark* mark = kept && kept->mark ? &*kept->mark : nullptr;
    const bool goes_on_within = mark != nullptr;  // the stage that it was at
    for (std::size_t b = 0; b < reached.matter.size(); ++b) {
        record["bodies"][b]["matter"] = reached.matter[b];
    }
    const auto recorder =
        kept ? std::make_unique<MotionRecorder>(
                   directory.store(), kept->motion, motion, mark ? mark->bodies : reached.bodies,
                   mark ? mark->skin : reached.skin, directory.is_changed())
             : std::make_unique<MotionRecorder>(directory.store(), scene.output.fields);
    int kept_stages = reached.stages;          // that are to be gone on from
    int kept_frame = recorder->frame_count();  // the last of these
    if (goes_on_within) {
        kept_frame = reached.stage.empty() ? 0 : reached.stage.back().at("frames").at(1).get<int>();
    }
    if (kept) {
        record["went_on_from"] = {{"stage", reached.stages + 1},
                                  {"frame", recorder->frame_count()}};
    }
    StageKeeper* keeps = nullptr;
    const auto add_where_it_goes_on = [&](Json& to) {
        if (!keeps->frame() && kept_stages == 0) return;
        to["goes_on_from"] = {{"stage", kept_stages + 1},
                              {"frame", keeps->frame().value_or(kept_frame)}};
    };
    // What stands there if the process is killed.
    const auto note = [&] {
        Json now = record;
        now["stages"] = reached.stage;
        add_where_it_goes_on(now);
        write_record(directory, now, watch);
    };
    StageKeeper keeper(directory, *recorder, watch, keep_every, note);
    keeps = &keeper;

    DiskReserve reserve;
    bool has_begun = false;
    const auto begin = [&] {
        if (has_begun) return;
        // Of the stage that it is within there may be meshes of frames.
        directory.begin(products_of_stages(scene, kept ? reached.stages + goes_on_within : 0));
        has_begun = true;
        if (kept) {
            directory.forget_kept_but(1, reached.stages);
        } else {
            directory.forget_kept();
        }
        if (!goes_on_within) keeper.forget();
        plots.forget_from(static_cast<std::size_t>(reached.stages));
        reserve.hold(directory.root(), 2 * json_text(record).size() + kRecordRoom +
                                           kStageRecordRoom * scene.stage.size());
        make_folder(directory.root() / "meshes");
        make_folder(directory.root() / "curves");
        if (kept || fs::exists(directory.record())) note();
    };
    const auto stages = static_cast<int>(scene.stage.size());
    if (kept) {
        for (const auto& [phase, seconds] : mark ? mark->seconds : reached.seconds) {
            watch.add(phase, seconds);
        }
        record["stages"] = reached.stage;
    }
    if (mark) {
        log_info("goes on from frame {}, in stage {} of {}{}", mark->frame, reached.stages + 1,
                 stages, directory.is_changed() ? ": " + directory.change() : "");
    } else if (kept) {
        log_info("goes on after stage {} of {}, frame {}{}", reached.stages, stages,
                 recorder->frame_count(), directory.is_changed() ? ": " + directory.change() : "");
    }
    Progress progress("simulate", frame_count(scene) - 1, std::max(0, recorder->frame_count() - 1));
    // Of what was there before nothing is lost for it.
    const auto is_in_vain = [&] {
        return recorder->frame_count() == 0 || (!has_begun && directory.is_changed());
    };
    Ended ended;
    while (reached.stages < stages) {
        const StageSpec& stage = scene.stage[static_cast<std::size_t>(reached.stages)];
        StageMark* const from = std::exchange(mark, nullptr);
        const StageContext context{scene, directory.root(), *recorder, watch, progress,
                                   begin, keeper,           from};
        keeper.begin(reached.stages, from ? std::optional(from->frame) : std::nullopt,
                     kept_stages == reached.stages);
        try {
            throw_if_interrupted();
            StageOutcome outcome =
                run_stage(stage, recorder->frame_count(), reached.bodies, context);
            reached.stage.push_back(std::move(outcome.record));
            reached.steps += outcome.steps;
            std::move(outcome.warning.begin(), outcome.warning.end(),
                      std::back_inserter(reached.warning));
            ended = {outcome.stopped, outcome.interrupted};
        } catch (const Interrupted& interrupted) {
            // While the stage was set up.
            if (is_in_vain()) throw;
            ended.interrupted = interrupted;
        } catch (const std::exception& error) {
            // A stage that cannot be set up at what those before have made, or written, or that
            // wants for memory.
            ended.stopped = failure_of(error);
            if (is_in_vain() || !ended.stopped) throw;
        }
        if (ended.early()) break;
        if (++reached.stages == stages && !scene.output.keep_stages) break;
        if (keep(directory, *recorder, watch, reached)) {
            kept_stages = reached.stages;
            kept_frame = recorder->frame_count();
            keeper.forget();
            if (!scene.output.keep_stages) directory.forget_kept_but(kept_stages, kept_stages);
            note();
        }
        if (reached.stages == stages) break;
        const auto lap = watch.lap("plot");
        plots.draw();
    }
    begin();
    reserve.release();
    recorder->finish();
    record["stages"] = reached.stage;
    record["frames"] = recorder->frame_count();
    record["steps"] = reached.steps;
    record["state_hash"] = hash_text(state_hash(reached.bodies));
    Json& told = record["warnings"] = Json::array();
    for (const auto* all : {&reached.start_warning, &reached.warning}) {
        for (const std::string& one : *all) told.push_back(one);
    }
    record["state"] = ended.interrupted ? RunState::interrupted
                      : ended.stopped   ? RunState::stopped
                                        : RunState::simulated;
    if (ended.stopped) record["stopped"] = ended.stopped->what();
    if (ended.early()) add_where_it_goes_on(record);
    write_record(directory, record, watch);
    if (!ended.early()) {
        forget_what_is_done(directory, scene);
    } else if (keeper.frame()) {
        log_info("swage run goes on from frame {}, in stage {} of {}", *keeper.frame(),
                 kept_stages + 1, stages);
    } else if (kept_stages > 0) {
        log_info("swage run goes on after stage {} of {}", kept_stages, stages);
    } else {
        log_info("swage run begins anew, as nothing of it is kept yet");
    }
    return ended;
}

}  // namespace swage
