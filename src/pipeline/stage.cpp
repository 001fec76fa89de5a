// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/atomic_file.h"
#include "base/bytes.h"
#include "base/failure.h"
#include "base/units.h"
#include "pipeline/bend_watch.h"
#include "pipeline/body_table.h"
#include "pipeline/boundary_note.h"
#include "pipeline/curves.h"
#include "pipeline/frame_account.h"
#include "pipeline/limit_watch.h"
#include "pipeline/machine_place.h"
#include "pipeline/motion_note.h"
#include "pipeline/parted_grips.h"
#include "pipeline/passed_watch.h"
#include "pipeline/piece_fields.h"
#include "pipeline/plot.h"
#include "pipeline/run_directory.h"
#include "pipeline/run_record.h"
#include "pipeline/stage_cuts.h"
#include "pipeline/stage_machine.h"
#include "pipeline/stage_meshes.h"
#include "pipeline/stage_verdict.h"
#include "pipeline/stage_way.h"
#include "pipeline/start_overlap.h"
#include "pipeline/start_warnings.h"
#include "pipeline/stiffness_note.h"
#include "pipeline/thin_pieces_note.h"
#include "pipeline/use_watch.h"
#include "pipeline/warning_book.h"
#include "scene/product_names.h"
#include "sim/advance.h"
#include "sim/given_up.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOpenSkin = "the skin could not be closed everywhere that matter broke";

// What is being handled, where it ends a stage that is told of as far as it came: a failure of this
// kind, or want of memory or threads. Anything else is thrown on.
Error failure_that_stops(ExitCode kind, const std::exception& error) {
    const std::optional<Error> failure = failure_of(error);
    if (failure && (failure->code() == kind || failure->code() == ExitCode::resources)) {
        return *failure;
    }
    throw;
}

class StageRun {
  public:
    StageRun(const StageSpec& stage, std::vector<WorkPiece>& bodies, const StageContext& context)
        : stage_(stage),
          bodies_(bodies),
          context_(context),
          connections_before_(connection_count(bodies)),
          volumes_before_(body_volumes(bodies)),
          overlaps_before_(overlaps_of(bodies, stage.sim)),
          machine_(stage_machine(stage, bodies.front().matter, materials_beside(named(bodies)),
                                 box_of(bodies.front().position))),
          told_deep_(start_deep(machine_, named(bodies), overlaps_before_, moves_as_molded())),
          pieces_before_(!machine_.apparatus.blade.empty() ? piece_count(bodies) : 0),
          way_(stage, machine_, bodies.front().matter),
          limits_(stage, machine_),
          use_(bodies),
          bend_(machine_, way_.now(), bodies.front().matter),
          cuts_(stage, machine_, way_, bodies, totals_, warnings_),
          meshes_(context.scene, stage, context.root) {
        const auto lap = context_.watch.lap("set up");
        tell_machine();
        warn_of_start();
    }

    StageOutcome run(int last_frame) {
        std::vector<Aggregate*> matter;
        for (WorkPiece& body : bodies_) matter.push_back(&body.matter);
        const MotionLeft began = motion_of(bodies_);  // which equilibria end
        Simulation simulation = [&] {
            const auto lap = context_.watch.lap("set up");
            return Simulation(matter, machine_.apparatus, stage_.sim);
        }();
        context_.begin();
        meshes_.make_folders();
        before_ = std::max(last_frame, 1);
        if (context_.from == nullptr) {
            context_.recorder.set_machine(machine_.apparatus);
            if (last_frame == 0) record_start();
        }
        begin_books(simulation);
        if (!in_motion(stage_.sim.solver)) warn_of_motion(began);
        if (context_.from != nullptr) {
            come_back(simulation, *context_.from);
        } else {
            simulation.take_on(std::exchange(context_.contacts, {}), could_not_touch_itself());
        }
        work_frames(simulation);
        if (!outcome_.stopped && !outcome_.interrupted) context_.contacts = simulation.hand_on();
        const auto lap = context_.watch.lap("write");
        write_products();
        finish();
        return std::move(outcome_);
    }

  private:
    // Whether the bodies come from equilibria in which their parts went through each other.
    bool could_not_touch_itself() const {
        const std::vector<StageSpec>& all = context_.scene.stage;
        const auto here = std::find_if(all.begin(), all.end(),
                                       [&](const StageSpec& one) { return &one == &stage_; });
        if (here == all.begin() || here == all.end()) return false;
        const SimSettings& before = std::prev(here)->sim;
        return !in_motion(before.solver) && !before.self_contact;
    }
    void tell_machine() const {
        const auto tell = [&](const std::string& text) { log_info("{}: {}", stage_.name, text); };
        const std::string axes = axes_text(machine_.frame);
        if (!axes.empty()) tell(axes);
        for (const std::string& load : load_texts(machine_)) tell(load);
        for (const std::string& limit : limit_texts(machine_.spec)) tell(limit);
        for (const std::string& note : machine_.notes) tell(note);
    }

    bool is_first() const { return &stage_ == &context_.scene.stage.front(); }
    bool moves_as_molded() const { return in_motion(stage_.sim.solver) && is_first(); }

    void warn_of_start() {
        std::vector<std::string> told = tool_overlaps(machine_, named(bodies_), moves_as_molded());
        const std::string note = stiffness_note(stage_, named(bodies_));
        if (!note.empty()) told.push_back(note);
        for (std::string& one : boundary_notes(bodies_)) told.push_back(std::move(one));
        for (std::string& one : thin_pieces_notes(bodies_, stage_.sim)) {
            told.push_back(std::move(one));
        }
        // Of the first stage it has been told as the run began (start_doubts.h).
        if (!is_first()) {
            const std::string parted = parted_grips(stage_, machine_, bodies_.front().matter);
            if (!parted.empty()) told.push_back(parted);
        }
        for (const std::string& one : told) warn(fmt::format("{}: {}", stage_.name, one));
    }

    void warn_of_motion(const MotionLeft& began) {
        const std::string note = motion_note(began, first_.elastic);
        if (!note.empty()) warn(fmt::format("{}: {}", stage_.name, note));
    }

    void work_frames(Simulation& simulation) {
        const int gone = context_.from != nullptr ? context_.from->frame - before_ : 0;
        for (int n = gone + 1; n <= stage_.frames && !outcome_.stopped; ++n) {
            if (!work(simulation, n, before_ + n)) break;
            keep([&] { record(before_ + n); });
            if (n < stage_.frames && !outcome_.stopped && context_.keeper.is_due()) {
                keep_stage(simulation, before_ + n);
            }
        }
    }

    void write_products() {
        for (std::size_t b = 0; is_whole() && b < bodies_.size(); ++b) {
            keep([&] { meshes_.write_end(b, bodies_[b]); });
        }
        const fs::path folder = context_.root / "curves";
        const fs::path table = folder / (stage_.name + ".csv");
        keep([&] { write_file_whole(table, csv_text(*curves_)); });
        keep([&] {
            write_file_whole(plot_program_of(table),
                             plot_program(*curves_, machine_.frame.size.norm()));
        });
        if (body_table_) {
            keep([&] {
                write_file_whole(folder / (body_table_name(stage_) + ".csv"),
                                 body_table_->csv_text());
            });
        }
    }

    // Where memory ran out, matter may stand in the middle of a step.
    bool is_whole() const {
        return !outcome_.stopped || outcome_.stopped->code() != ExitCode::resources;
    }
    std::vector<ProbePlace> probes() const { return probe_places(context_.scene.body, bodies_); }
    std::vector<SkinFieldValues> fields_now() const {
        return fields_on_skins(bodies_, context_.scene.output.fields);
    }
    void warn(std::string sentence) {
        log_warning("{}", sentence);
        outcome_.warning.push_back(std::move(sentence));
    }
    // What cannot be written, as on a full disk or for want of memory, ends the stage where it is,
    // and no more. What cannot be written after that is told.
    template <typename Write>
    void keep(const Write& write) {
        try {
            write();
        } catch (const std::exception& error) {
            const Error failure = failure_that_stops(ExitCode::output, error);
            if (outcome_.stopped) {
                warn(failure.what());
            } else {
                outcome_.stopped = failure;
            }
        }
    }

    // The untouched start of the run has a frame of its own.
    void record_start() {
        const std::vector<SkinFieldValues> values = fields_now();
        context_.recorder.add_frame(bodies_, way_.now(), values);
        keep([&] { meshes_.write_frame(before_, bodies_, values); });
    }

    void begin_books(const Simulation& simulation) {
        const Apparatus& apparatus = machine_.apparatus;
        first_ = simulation.start();
        last_ = first_;  // until a leg is done
        last_.contact = 0;
        curves_.emplace(stage_.name, before_, simulation.loads(way_.now()), first_,
                        apparatus.tool.size() + apparatus.grip.size() + apparatus.blade.size(),
                        turn_axes(machine_), probes());
        if (in_motion(stage_.sim.solver)) body_table_.emplace(before_, bodies_, first_);
    }

    // What its frames change, beside the bodies and their simulation.
    template <typename Io>
    void visit(Io& io) {
        io(before_, way_, limits_, use_, bend_, cuts_, first_, last_, totals_, warnings_, *curves_);
        if (body_table_) io(*body_table_);
    }

    void keep_stage(const Simulation& simulation, int number) {
        context_.keeper.keep(number, bodies_, [&](ByteWriter& out) {
            visit(out);
            simulation.save(out);
        });
    }

    // The machine and the simulation have been set up as the stage began.
    void come_back(Simulation& simulation, StageMark& mark) {
        try {
            bodies_ = mark.bodies;
            ByteReader state(std::span(mark.bytes).subspan(mark.state));
            visit(state);
            simulation.load(state);
            if (state.left() > 0) fail(ExitCode::output, "it holds more than that");
            std::vector<WorkPiece>().swap(mark.bodies);  // the room
            std::string().swap(mark.bytes);
        } catch (const Error& error) {
            context_.keeper.forget();
            fail(ExitCode::output, "{}: what was kept of it cannot be gone on from: {}",
                 stage_.name, error.what());
        }
    }

    // The machine goes through the n-th frame; false where that was given up. What was done of it,
    // to where the matter was last at rest or its steps were last right, is on the books and in
    // the skins either way.
    bool work(Simulation& simulation, int n, int number) {
        int legs = 0;
        FrameReport frame;
        try {
            for (; way_.goes_on_in(n); ++legs) {
                throw_if_interrupted();
                if (legs > 0) follow_on_the_way();
                cuts_.plan(simulation, legs > 0 ? frame : last_, number);
                const PassedWatch uncut(bodies_, machine_.apparatus, stage_.sim,
                                        cuts_.coming_again());
                FrameReport report = [&] {
                    const auto lap = context_.watch.lap("simulate");
                    return simulation.advance(way_.now(), way_.next(), way_.between());
                }();
                totals_.passed += uncut.count_passed(way_.now(), way_.next(), simulation);
                totals_.passed_again += uncut.count_again(way_.now(), way_.next(), simulation);
                if (report.severed > 0) hold_skins();
                if (report.stop) {
                    stop(*report.stop, simulation, number);
                } else {
                    way_.go_on();
                }
                limits_.look(number, report, way_.goes_on_in(n));
                bend_.look(number, way_.now(), bodies_.front().matter);
                frame.go_on(std::move(report));
                curves_->pass(frame.load);
            }
        } catch (const Interrupted& interrupted) {
            outcome_.interrupted = interrupted;
        } catch (const GivenUp& given_up) {
            // A leg as far as it came.
            if (given_up.report().severed > 0) hold_skins();
            frame.go_on(given_up.report());
            ++legs;
            give_up(given_up, number);
        } catch (const std::exception& error) {
            give_up(failure_that_stops(ExitCode::stopped, error), number);
        }
        const bool goes_on = !outcome_.interrupted && !outcome_.stopped;
        if (legs > 0) {
            book(number, std::move(frame));
        } else if (!goes_on && is_whole()) {
            dress(number);  // it may have moved all the same
        }
        return goes_on;
    }

    void give_up(const Error& why, int number) {
        outcome_.stopped.emplace(why.code(),
                                 fmt::format("{}, frame {}: {}", stage_.name, number, why.what()));
    }

    // What the matter has gone through is on the books, whether the frame can be kept or not.
    void book(int number, FrameReport frame) {
        last_ = std::move(frame);
        dress(number);
        use_.look(number, bodies_);
        curves_->add(number, last_, probes());
        if (body_table_) body_table_->add(number, bodies_, last_);
        totals_.add(number, last_, machine_.apparatus.tool.size());
        for (const std::string& sentence : last_.warning) warnings_.add(number, sentence);
        log_verbose("{}, frame {}: {}", stage_.name, number, frame_account(last_));
    }

    // The machine has reached a limit, and goes on without coming any farther.
    void stop(const LimitStop& at, Simulation& simulation, int number) {
        way_.stop(at.at);
        cuts_.plan_anew(simulation, last_, number);
    }

    // A skin is cut, and held where it is severed, where it is as a leg begins.
    void follow_on_the_way() {
        if (!cuts_.any_blade()) return;
        const auto lap = context_.watch.lap("skin");
        for (WorkPiece& body : bodies_) follow_matter(body);
    }
    void hold_skins() {
        const auto lap = context_.watch.lap("skin");
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (cuts_.is_cut(b)) hold_skin(bodies_[b]);
        }
    }

    void dress(int number) {
        const auto lap = context_.watch.lap("skin");
        const bool has_parted = last_.broken + last_.severed > 0;
        for (WorkPiece& body : bodies_) {
            if (show_matter(body, has_parted) > 0) warnings_.add(number, kOpenSkin);
        }
    }

    void record(int number) {
        const std::vector<SkinFieldValues> values = [&] {
            const auto lap = context_.watch.lap("skin");
            return fields_now();
        }();
        const auto lap = context_.watch.lap("write");
        context_.recorder.add_frame(bodies_, way_.now(), values);
        meshes_.write_frame(number, bodies_, values);
        context_.progress.advance(number - 1, stage_.name);
    }

    int last_row() const { return before_ + static_cast<int>(curves_->rows()) - 1; }

    void finish() {
        const StageEnd end{.stage = stage_,
                           .machine = machine_,
                           .bodies = bodies_,
                           .totals = totals_,
                           .first = first_,
                           .last = last_,
                           .first_frame = before_ + 1,
                           .last_frame = std::min(last_row(), context_.recorder.frame_count()),
                           .legs = way_.legs(),
                           .connections_before = connections_before_,
                           .volumes_before = volumes_before_,
                           .overlaps_before = overlaps_before_,
                           .told_deep = told_deep_,
                           .probes = probes()};
        const StageEnded ended = outcome_.interrupted ? StageEnded::interrupted
                                 : outcome_.stopped   ? StageEnded::stopped
                                                      : StageEnded::wholly;
        StageVerdict verdict = judge_stage(end, pieces_before_, ended);
        for (std::string& one : warnings_.told(stage_.name)) warn(std::move(one));
        for (std::string& one : limits_.warnings(ended == StageEnded::wholly)) {
            warn(std::move(one));
        }
        if (way_.lost() > 0) {
            warn(
                fmt::format("{}: in {} of its frames the machine's motion is more than {} steps "
                            "can follow; use more frames",
                            stage_.name, way_.lost(), kMostLegs));
        }
        for (std::string& one : verdict.warning) warn(std::move(one));
        if (const std::string told = bend_.warning(bodies_.front().matter); !told.empty()) {
            warn(fmt::format("{}: {}", stage_.name, told));
        }
        outcome_.steps = totals_.iterations + totals_.steps;
        outcome_.record = stage_record(end, *curves_, verdict.overlap, outcome_.warning);
        limits_.add_to(outcome_.record);
        bend_.add_to(outcome_.record, bodies_.front().matter);
        outcome_.record["use"] = use_.json(bodies_);
        // Its row and the meshes are of the way to it.
        if (last_row() > end.last_frame) outcome_.record["unfinished_frame"] = last_row();
        outcome_.record["state"] = ended == StageEnded::interrupted ? RunState::interrupted
                                   : ended == StageEnded::stopped   ? RunState::stopped
                                                                    : RunState::complete;
    }

    const StageSpec& stage_;
    std::vector<WorkPiece>& bodies_;
    const StageContext& context_;
    const std::size_t connections_before_;
    const std::vector<BodyVolume> volumes_before_;
    const std::vector<double> overlaps_before_;
    Machine machine_;  // it may come to stop
    const std::vector<char> told_deep_;
    const int pieces_before_;
    StageWay way_;
    LimitWatch limits_;
    UseWatch use_;
    BendWatch bend_;
    StageTotals totals_;
    WarningBook warnings_;
    StageCuts cuts_;
    const StageMeshes meshes_;
    int before_ = 0;  // the last frame before the stage
    std::optional<StageCurves> curves_;
    std::optional<BodyTable> body_table_;  // of a stage in motion
    FrameReport first_, last_;
    StageOutcome outcome_;
};

WorkPiece mold_stage_anew(const StageSpec& stage, std::size_t body, const WorkPiece& piece,
                          const SceneSpec& scene) {
    const auto number = static_cast<std::size_t>(&stage - scene.stage.data());
    try {
        return mold_anew(piece, scene.body[body], scene.skin, carries_insets(scene, number, true));
    } catch (const Error& error) {
        fail(error.code(), "{}: {}", stage.name, error.what());
    }
}

}  // namespace

StageOutcome run_stage(const StageSpec& stage, int last_frame, std::vector<WorkPiece>& bodies,
                       const StageContext& context) {
    std::vector<std::string> told;
    if (stage.remold) {
        const auto lap = context.watch.lap("mold");
        std::vector<WorkPiece> anew;  // where one cannot be, all stay as they were
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            throw_if_interrupted();
            anew.push_back(mold_stage_anew(stage, b, bodies[b], context.scene));
            for (const std::string& warning :
                 warnings_of_mold(anew[b].name, bodies.size() > 1, anew[b].finding)) {
                told.push_back(fmt::format("{}: {}", stage.name, warning));
                log_warning("{}", told.back());
            }
        }
        bodies = std::move(anew);
        context.contacts.clear();
        log_info("{}: molded anew: {} particles, cells of {}", stage.name, particle_count(bodies),
                 quantity_text(bodies.front().matter.lattice.spacing, Quantity::length));
    }
    StageOutcome outcome = StageRun(stage, bodies, context).run(last_frame);
    outcome.warning.insert(outcome.warning.begin(), told.begin(), told.end());
    return outcome;
}

}  // namespace swage
