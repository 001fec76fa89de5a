// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/simulate.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/failure.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/progress.h"
#include "pipeline/checkpoint.h"
#include "pipeline/cost.h"
#include "pipeline/disk_reserve.h"
#include "pipeline/folded_bodies.h"
#include "pipeline/kept_run.h"
#include "pipeline/run_record.h"
#include "pipeline/stage.h"
#include "pipeline/stage_machine.h"
#include "pipeline/stage_products.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// What run.json may need beside what it holds already: times, warnings, and each stage's books.
constexpr std::uint64_t kRecordRoom = 64 << 10, kStageRecordRoom = 16 << 10;

// Everything at its start.
Reached molded(const SimulationContext& context, StartWarnings at_start) {
    const std::vector<InputMesh>& input = context.input;
    Reached reached;
    std::vector<WorkPiece>& bodies = reached.bodies;
    std::vector<std::vector<std::string>> found, made, divided;
    for (std::size_t b = 0; b < input.size(); ++b) {
        const auto lap = context.watch.lap("mold");
        bodies.push_back(make_work_piece(input[b], context.scene.body[b], context.scene.skin,
                                         carries_insets(context.scene, 0)));
        const Aggregate& matter = bodies[b].matter;
        found.push_back(bodies[b].finding);
        made.push_back(
            {fmt::format("{} cells of {}, {} particles, {} connections, {:.4g} kg",
                         matter.cell_fill.size(), length_text(matter.lattice.spacing),
                         matter.particle_count(), matter.connection_count(), matter.mass())});
        divided.emplace_back();
        const std::string text = division_text(bodies[b], input[b], context.scene.skin);
        if (!text.empty()) divided.back().push_back(text);
        reached.matter.push_back(matter_json(matter));
    }
    const std::vector<std::string> name = body_names(context.scene);
    for (const FoldedText& one : folded(made)) {
        if (input.size() == 1) {
            log_info("molded: {}", one.text);
        } else {
            log_info("molded {}{}: {}", bodies_text(name, one.body),
                     one.body.size() == 1 ? "" : ", each", one.text);
        }
    }
    for (const FoldedText& one : folded(divided)) {
        if (input.size() > 1) {
            log_info("{}: {}", bodies_text(name, one.body), one.text);
        } else {
            log_info("{}", one.text);
        }
    }
    at_start.mold = folded_warnings(name, found);
    for (const std::string& warning : at_start.mold) log_warning("{}", warning);
    at_start.bodies = warnings_of_bodies(context.scene, named(bodies));
    for (const auto* untold : {&at_start.strength, &at_start.bodies}) {
        for (const std::string& warning : *untold) log_warning("{}", warning);
    }
    reached.start_warning = at_start.all();
    reached.foreseen = context.directory.stage_keys().back();
    return reached;
}

// From its start, or from where an earlier run of the same scene got to, stage by stage.
class SimulationRun {
  public:
    SimulationRun(const SimulationContext& context, StartWarnings at_start)
        : context_(context),
          kept_(kept_by_earlier_run(context.scene, context.directory)),
          reached_(start(std::move(at_start))),
          recorder_(make_recorder()),
          checkpoint_(checkpoint_now()),
          keeper_(context.directory, recorder_, context.watch, context.keep_every,
                  [this] { note(); }),
          progress_("simulate", frame_count(context.scene) - 1,
                    std::max(0, recorder_.frame_count() - 1)) {
        take_up_record();
        tell_where_it_starts();
    }

    Ended run() {
        while (!is_done()) {
            work_stage();
            if (ended_.early()) break;
            ++reached_.stages;
            if (!is_done() || context_.scene.output.keep_stages) keep_stages();
            if (!is_done()) draw_plots();
        }
        begin();  // where no stage has come to its first frame
        write_outcome();
        if (ended_.early()) {
            tell_where_it_goes_on();
        } else if (context_.scene.output.keep_stages) {
            forget_what_is_within(context_.directory);
        } else {
            context_.directory.forget_kept();
        }
        return ended_;
    }

  private:
    // Finished stages that a later run can go on from, and the last frame of these.
    struct Checkpoint {
        int stages = 0, frame = 0;
    };

    int stage_count() const { return static_cast<int>(context_.scene.stage.size()); }
    bool is_done() const { return reached_.stages == stage_count(); }
    // Where all stages are kept it is in the last that anything is gone on.
    int stage_after(int done) const { return std::min(done + 1, stage_count()); }

    // Within the stage that is at work or next; null: that begins at its start.
    StageMark* mark() {
        const bool is_within = kept_ && kept_->mark && kept_->mark->stages == reached_.stages;
        return is_within ? &*kept_->mark : nullptr;
    }

    Checkpoint checkpoint_now() const {
        const Json& stage = reached_.stage;
        return {reached_.stages, stage.empty() ? 0 : stage.back().at("frames").at(1).get<int>()};
    }

    Reached start(StartWarnings at_start) {
        if (!kept_ || !kept_->reached) return molded(context_, std::move(at_start));
        Reached reached = std::move(*kept_->reached);
        // What is told of the start foresees later stages too. They may have been changed by a run
        // that has ended since, and kept nothing of its own.
        if (reached.foreseen != context_.directory.stage_keys().back()) {
            Reached anew = molded(context_, std::move(at_start));
            reached.start_warning = std::move(anew.start_warning);
            reached.foreseen = std::move(anew.foreseen);
            for (int n = 0; n < reached.stages; ++n) {
                forget_foreseen(reached.start_warning,
                                context_.scene.stage[static_cast<std::size_t>(n)]);
            }
        }
        return reached;
    }

    MotionRecorder make_recorder() {
        const fs::path store = context_.directory.store();
        if (!kept_) return MotionRecorder(store, context_.scene.output.fields);
        const bool stays = context_.directory.is_changed();
        if (const StageMark* at = mark()) {
            return {store, kept_->motion, at->motion, at->bodies, at->skin, stays};
        }
        return {store, kept_->motion, reached_.motion, reached_.bodies, reached_.skin, stays};
    }

    void take_up_record() {
        Json& record = context_.record;
        for (std::size_t b = 0; b < reached_.matter.size(); ++b) {
            record["bodies"][b]["matter"] = reached_.matter[b];
        }
        if (!kept_) return;
        record["went_on_from"] = {{"stage", stage_after(reached_.stages)},
                                  {"frame", recorder_.frame_count()}};
        record["stages"] = reached_.stage;
        for (const auto& [phase, seconds] : mark() ? mark()->seconds : reached_.seconds) {
            context_.watch.add(phase, seconds);
        }
    }

    void tell_where_it_starts() {
        if (!kept_) return;
        const RunDirectory& directory = context_.directory;
        const std::string change = directory.is_changed() ? ": " + directory.change() : "";
        if (const StageMark* at = mark()) {
            log_info("goes on from frame {}, in stage {} of {}{}", at->frame, reached_.stages + 1,
                     stage_count(), change);
        } else {
            log_info("goes on after stage {} of {}, frame {}{}", reached_.stages, stage_count(),
                     recorder_.frame_count(), change);
        }
    }

    void work_stage() {
        const StageSpec& stage = context_.scene.stage[static_cast<std::size_t>(reached_.stages)];
        StageMark* const from = mark();
        const StageContext context{
            context_.scene,   context_.directory.root(), recorder_, context_.watch,
            progress_,        [this] { begin(); },       keeper_,   from,
            reached_.contacts};
        keeper_.begin(
            reached_.stages, from ? std::optional(from->frame) : std::nullopt,
            checkpoint_.stages == reached_.stages ? StageStart::is_kept : StageStart::is_lost);
        try {
            throw_if_interrupted();
            take(run_stage(stage, recorder_.frame_count(), reached_.bodies, context));
        } catch (const Interrupted& interrupted) {
            // While the stage was set up.
            if (is_in_vain()) end_in_vain();
            ended_.interrupted = interrupted;
        } catch (const std::exception& error) {
            // A stage that cannot be set up at what those before have made, or written, or that
            // wants for memory.
            ended_.stopped = failure_of(error);
            if (!ended_.stopped) throw;
            if (is_in_vain()) end_in_vain();
        }
    }

    // Of a stage that could be set up.
    void take(StageOutcome outcome) {
        forget_foreseen(reached_.start_warning,
                        context_.scene.stage[static_cast<std::size_t>(reached_.stages)]);
        reached_.stage.push_back(std::move(outcome.record));
        reached_.steps += outcome.steps;
        std::move(outcome.warning.begin(), outcome.warning.end(),
                  std::back_inserter(reached_.warning));
        ended_ = {outcome.stopped, outcome.interrupted};
    }

    // Of what was there before nothing is lost for it.
    bool is_in_vain() const {
        return recorder_.frame_count() == 0 || (!has_begun_ && context_.directory.is_changed());
    }

    // Throws what is being handled.
    [[noreturn]] void end_in_vain() const {
        if (context_.directory.is_changed()) {
            log_info("{}: the run that was there stays as it was",
                     context_.directory.root().string());
        }
        throw;
    }

    // What makes room for the run goes, once its first frame is to come.
    void begin() {
        if (has_begun_) return;
        RunDirectory& directory = context_.directory;
        // Of the stage that it is within there may be meshes of frames.
        const int products = kept_ ? reached_.stages + (mark() ? 1 : 0) : 0;
        directory.begin(products_of_stages(context_.scene, products));
        has_begun_ = true;
        if (kept_) {
            directory.forget_kept_but(1, reached_.stages);
        } else {
            directory.forget_kept();
        }
        if (!mark()) keeper_.forget();
        context_.plots.forget_from(static_cast<std::size_t>(reached_.stages));
        reserve_.hold(directory.root(), 2 * json_text(context_.record).size() + kRecordRoom +
                                            kStageRecordRoom * context_.scene.stage.size());
        make_folder(directory.root() / "meshes");
        make_folder(directory.root() / "curves");
        if (kept_ || fs::exists(directory.record())) note();
    }

    void keep_stages() {
        if (!write_reached()) return;
        checkpoint_ = checkpoint_now();
        keeper_.forget();
        if (!context_.scene.output.keep_stages) {
            context_.directory.forget_kept_but(checkpoint_.stages, checkpoint_.stages);
        }
        note();
    }

    // Whether that could be done; the run goes on all the same.
    bool write_reached() {
        const RunDirectory& directory = context_.directory;
        const auto lap = context_.watch.lap("keep");
        try {
            make_folder(directory.resume());
            recorder_.keep(directory.kept_motion());
            reached_.motion = recorder_.mark();
            reached_.skin = recorder_.skins();
            reached_.seconds = context_.watch.phases();
            write_checkpoint(directory.checkpoint(reached_.stages), directory.stage_keys(),
                             reached_);
            return true;
        } catch (const std::exception& error) {
            const std::optional<Error> failure = failure_of(error);
            if (!failure) throw;
            unkept_.push_back(fmt::format("{}; no run can go on from here", failure->what()));
            log_warning("{}", unkept_.back());
            return false;
        }
    }

    void draw_plots() {
        const auto lap = context_.watch.lap("plot");
        context_.plots.draw();
    }

    // What stands in run.json if the process is killed.
    void note() {
        Json now = context_.record;
        now["stages"] = reached_.stage;
        add_where_it_goes_on(now);
        write_record(context_.directory, now, context_.watch);
    }

    void add_where_it_goes_on(Json& record) const {
        if (!keeper_.frame() && checkpoint_.stages == 0) return;
        record["goes_on_from"] = {{"stage", stage_after(checkpoint_.stages)},
                                  {"frame", keeper_.frame().value_or(checkpoint_.frame)}};
    }

    void write_outcome() {
        Json& record = context_.record;
        reserve_.release();
        recorder_.finish();
        record["stages"] = reached_.stage;
        record["frames"] = recorder_.frame_count();
        record["steps"] = reached_.steps;
        record["state_hash"] = hash_text(state_hash(reached_.bodies));
        Json& told = record["warnings"];  // those of the scene
        const auto tell = [&](const std::vector<std::string>& all) {
            for (const std::string& one : all) told.push_back(one);
        };
        tell(reached_.start_warning);
        tell(reached_.warning);
        tell(keeper_.warnings());
        tell(unkept_);
        record["state"] = ended_.interrupted ? RunState::interrupted
                          : ended_.stopped   ? RunState::stopped
                                             : RunState::simulated;
        if (ended_.stopped) record["stopped"] = ended_.stopped->what();
        if (ended_.early()) add_where_it_goes_on(record);
        write_record(context_.directory, record, context_.watch);
    }

    void tell_where_it_goes_on() const {
        if (keeper_.frame()) {
            log_info("swage run goes on from frame {}, in stage {} of {}", *keeper_.frame(),
                     checkpoint_.stages + 1, stage_count());
        } else if (checkpoint_.stages > 0) {
            log_info("swage run goes on after stage {} of {}", checkpoint_.stages, stage_count());
        } else {
            log_info("swage run begins anew, as nothing of it is kept yet");
        }
    }

    const SimulationContext& context_;
    std::optional<KeptRun> kept_;  // by an earlier run, which this goes on from
    Reached reached_;
    MotionRecorder recorder_;
    Checkpoint checkpoint_;
    StageKeeper keeper_;
    DiskReserve reserve_;
    std::vector<std::string> unkept_;  // warnings of how stages ended, which could not be kept
    bool has_begun_ = false;
    Progress progress_;
    Ended ended_;
};

}  // namespace

Ended simulate(const SimulationContext& context, StartWarnings at_start) {
    return SimulationRun(context, std::move(at_start)).run();
}

}  // namespace swage
