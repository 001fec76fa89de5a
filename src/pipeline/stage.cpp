// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/text.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_write.h"
#include "machines/legs.h"
#include "pipeline/curves.h"
#include "pipeline/plot.h"
#include "pipeline/run_directory.h"
#include "pipeline/stage_machine.h"
#include "sim/advance.h"
#include "sim/motion_guard.h"
#include "sim/own_overlap.h"
#include "sim/sever.h"
#include "skin/cut_mesh.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOpenSkin = "the skin could not be closed everywhere that matter broke";
constexpr double kOverlap = 0.5;  // spacings that a body may lie in itself untold

// Warnings that come back frame after frame are told once, with the frames they came in.
class WarningBook {
  public:
    void add(int frame, const std::string& sentence) {
        auto [at, is_new] = frames_.try_emplace(sentence);
        if (is_new) order_.push_back(sentence);
        at->second.push_back(frame);
    }
    std::vector<std::string> told(const std::string& stage) const {
        std::vector<std::string> lines;
        for (const std::string& sentence : order_) {
            const std::vector<int>& frames = frames_.at(sentence);
            lines.push_back(frames.size() == 1
                                ? fmt::format("{}, frame {}: {}", stage, frames[0], sentence)
                                : fmt::format("{}, {} frames from {} on: {}", stage, frames.size(),
                                              frames[0], sentence));
        }
        return lines;
    }

  private:
    std::map<std::string, std::vector<int>> frames_;
    std::vector<std::string> order_;
};

struct Totals {
    long iterations = 0, increments = 0, halvings = 0, steps = 0, rejected = 0, rescued = 0,
         severed = 0, broken = 0;
    double shortest_step = 0;  // [s]
    double residual = 0, penetration = 0;
    bool touched = false;  // by a tool

    void add(const FrameReport& report, std::size_t tools) {
        iterations += report.iterations;
        increments += report.increments;
        halvings += report.halvings;
        steps += report.steps;
        rejected += report.rejected;
        rescued += report.rescued;
        if (report.steps > 0) {
            shortest_step = shortest_step > 0 ? std::min(shortest_step, report.shortest_step)
                                              : report.shortest_step;
        }
        severed += report.severed;
        broken += report.broken;
        residual = std::max(residual, report.residual);
        for (std::size_t n = 0; n < report.load.size(); ++n) {
            penetration = std::max(penetration, report.load[n].penetration);
            touched = touched || (n < tools && report.load[n].touched);
        }
    }
};

// Where a body's meshes go: under the stage's name, and its own where there are several.
fs::path mesh_stem(const fs::path& root, const std::string& stage,
                   const std::vector<WorkPiece>& bodies, std::size_t body) {
    return root / "meshes" / (bodies.size() == 1 ? stage : stage + "-" + bodies[body].name);
}

void write_meshes(const TriMesh& mesh, const fs::path& stem) {
    write_obj(fs::path(stem) += ".obj", mesh);
    write_ply(fs::path(stem) += ".ply", mesh);
}

Json parameters_json(const Machine& machine) {
    Json json = Json::object();
    for (const ParameterSpec& spec : machine.spec.parameter) {
        json[spec.name] = {{"value", machine.parameter.at(spec.name)},
                           {"unit", si_unit(spec.quantity)}};
    }
    return json;
}

Json energies_json(const Books& last) {
    return {{"machine_work", last.work},
            {"load_work", last.load_work},
            {"gravity_work", last.gravity_work},
            {"kinetic", last.kinetic},
            {"elastic", last.elastic},
            {"contact", last.contact},
            {"passed", last.passed},
            {"plastic", last.plastic},
            {"damped", last.damped},
            {"friction", last.friction},
            {"drag", last.drag},
            {"severed", last.severed_energy},
            {"fracture", last.fracture},
            {"set_free", last.set_free},
            {"remainder", last.remainder}};
}

void write_curves(const StageCurves& curves, const StageContext& context) {
    const fs::path stem = context.root / "curves" / curves.stage();
    write_file_whole(fs::path(stem) += ".csv", csv_text(curves));
    if (context.can_plot && !is_stopping()) draw_plot(curves, fs::path(stem) += ".svg");
}

// What a blade sweeps as it turns lies between its poses in steps at most this long.
constexpr int kBladeSteps = 64;  // of a stage, at least
int blade_steps(const std::vector<Leg>& legs) {
    double longest = 0;
    for (const Leg& leg : legs) longest = std::max(longest, leg.end - leg.begin);
    return static_cast<int>(std::ceil(kBladeSteps * longest * (1 - 1e-9)));
}

// The skin is cut along the whole path of the stage's blades when they reach the matter. True when
// that was not possible everywhere, so that torn triangles must be removed as they appear.
bool cut_ahead(const Machine& machine, std::span<const Drive> way, WorkPiece& piece, SkinKind kind,
               int frame, WarningBook& warnings) {
    if (kind == SkinKind::boundary) return false;
    const CutResult cut = cut_skins(piece, swept_triangles(machine.apparatus, way));
    follow_matter(piece, kind);
    if (cut.open_parts > 0) {
        warnings.add(frame,
                     fmt::format("{} open part{} of the skin could not be closed where it is cut",
                                 cut.open_parts, cut.open_parts == 1 ? "" : "s"));
    }
    if (cut.has_curved) {
        warnings.add(frame, "a blade's path is curved, so the skin is torn along it, not cut");
    }
    return cut.has_curved;
}

std::size_t particle_count(const std::vector<WorkPiece>& bodies) {
    std::size_t count = 0;
    for (const WorkPiece& body : bodies) count += body.matter.particle_count();
    return count;
}

std::size_t connection_count(const std::vector<WorkPiece>& bodies) {
    std::size_t count = 0;
    for (const WorkPiece& body : bodies) count += body.matter.connection_count();
    return count;
}

// What strains of a billionth would hold [J]: less is round-off.
double round_off(const std::vector<WorkPiece>& bodies) {
    double sum = 0;
    for (const WorkPiece& body : bodies) {
        const Material& m = body.matter.material;
        sum += 1e-18 * m.young_modulus * body.matter.mass() / m.density;
    }
    return sum;
}

// In motion, of what the books hold by now, the share that is missing or too much. Fracture takes
// energy: what it gives is from nowhere.
double unaccounted(const Books& b, double least) {
    const double in = std::abs(b.work) + std::abs(b.load_work) + std::abs(b.gravity_work);
    const double out = b.kinetic + b.elastic + b.contact + b.plastic + b.damped + b.friction +
                       b.drag + std::abs(b.severed_energy) + std::max(0.0, b.fracture);
    const double play = std::max(in, out);
    return play > least ? (b.remainder + std::min(0.0, b.fracture)) / play : 0;
}

int piece_count(const std::vector<WorkPiece>& bodies) {
    int count = 0;
    for (const WorkPiece& body : bodies) count += find_pieces(body.matter).count;
    return count;
}

}  // namespace

StageOutcome run_stage(const StageSpec& stage, int last_frame, std::vector<WorkPiece>& bodies,
                       const StageContext& context) {
    const SkinKind skin = context.scene.skin.kind;
    const double duration = context.scene.duration_of(stage);
    StageOutcome outcome;
    if (stage.remold) {
        const auto lap = context.watch.lap("mold");
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            bodies[b] = mold_anew(bodies[b], context.scene.body[b], skin);
        }
        log_info("{}: molded anew: {} particles", stage.name, particle_count(bodies));
    }
    const std::size_t connections_before = connection_count(bodies);

    const Aggregate& work_piece = bodies.front().matter;
    std::vector<Material> beside;
    for (std::size_t b = 1; b < bodies.size(); ++b) beside.push_back(bodies[b].matter.material);
    const Machine machine = stage_machine(stage, work_piece, beside);
    const bool cuts_any = !machine.apparatus.blade.empty();
    const int pieces_before = cuts_any ? piece_count(bodies) : 0;
    for (const std::string& note : machine.notes) log_info("{}: {}", stage.name, note);
    const Legs legs = stage_legs(machine, stage.frames, work_piece);
    const int steps = cuts_any ? blade_steps(legs.leg) : 1;
    const std::vector<Drive> way = drives_of(machine, legs.leg, steps, duration);
    const Drive& start = way.front();
    context.recorder.set_machine(machine.apparatus);
    if (last_frame == 0) {
        context.recorder.add_frame(bodies, start);
        last_frame = 1;
    }
    const int first_frame = last_frame + 1;
    std::vector<Aggregate*> matter;
    for (WorkPiece& body : bodies) matter.push_back(&body.matter);
    Simulation simulation(matter, machine.apparatus, stage.sim);
    StageCurves curves(stage.name, last_frame, simulation.loads(start));
    WarningBook warnings;
    Totals totals;
    std::vector<fs::path> meshes;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        meshes.push_back(mesh_stem(context.root, stage.name, bodies, b));
        if (context.scene.output.meshes_per_frame) make_folder(meshes[b]);
    }
    std::vector<char> cuts(bodies.size(), 0);
    bool tears = false;
    FrameReport last;
    std::span<const Drive> ahead(way);
    std::size_t leg = 0;
    for (int n = 1; n <= stage.frames; ++n) {
        const int number = last_frame + n;
        try {
            FrameReport frame;
            for (; leg < legs.leg.size() && legs.leg[leg].frame == n - 1; ++leg) {
                for (std::size_t b = 0; b < bodies.size(); ++b) {
                    if (cuts[b] || !simulation.blades_reach(b, ahead.first(steps + 1))) continue;
                    // From here on the whole cut is settled: in the matter and, along the same
                    // path, the skin.
                    cuts[b] = 1;
                    simulation.plan_cuts(b, ahead, steps);
                    tears = cut_ahead(machine, ahead, bodies[b], skin, number, warnings) || tears;
                }
                const auto lap = context.watch.lap("simulate");
                throw_if_interrupted();
                frame.go_on(simulation.advance(ahead.front(), ahead[steps]));
                curves.pass(frame.load);
                ahead = ahead.subspan(steps);
            }
            last = std::move(frame);
        } catch (const Interrupted& interrupted) {
            outcome.interrupted = interrupted;
            break;
        } catch (const Error& error) {
            if (error.code() != ExitCode::stopped) throw;
            outcome.stopped.emplace(ExitCode::stopped, fmt::format("{}, frame {}: {}", stage.name,
                                                                   number, error.what()));
            break;
        }
        {
            const auto lap = context.watch.lap("skin");
            for (WorkPiece& body : bodies) {
                const bool parts = last.broken + last.severed > 0;
                if (parts && skin != SkinKind::boundary && show_breaks(body) > 0) {
                    warnings.add(number, kOpenSkin);
                }
                follow_matter(body, skin);
                if (tears) remove_torn_triangles(body.skin, body.mount, body.matter);
            }
        }
        const auto lap = context.watch.lap("write");
        context.recorder.add_frame(bodies, ahead.front());
        curves.add(number, last);
        totals.add(last, machine.apparatus.tool.size());
        for (const std::string& sentence : last.warning) warnings.add(number, sentence);
        for (std::size_t b = 0; b < bodies.size() && context.scene.output.meshes_per_frame; ++b) {
            write_meshes(bodies[b].deformed(), meshes[b] / fmt::format("frame_{:04d}", number));
        }
        context.progress.advance(number - 1, stage.name);
    }

    const auto lap = context.watch.lap("write");
    for (std::size_t b = 0; b < bodies.size(); ++b) write_meshes(bodies[b].deformed(), meshes[b]);
    write_curves(curves, context);
    outcome.warning = warnings.told(stage.name);
    if (legs.lost > 0) {
        outcome.warning.push_back(fmt::format(
            "{}: in {} of its frames the machine does what 64 steps do not follow; more frames do",
            stage.name, legs.lost));
    }
    const bool ended_early = outcome.stopped || outcome.interrupted;
    if (!machine.apparatus.tool.empty() && !totals.touched && !ended_early) {
        outcome.warning.push_back(stage.name + ": its tools never touched the work-piece");
    }
    if (totals.severed > 0 && !ended_early && piece_count(bodies) == pieces_before) {
        outcome.warning.push_back(fmt::format(
            "{}: the blade has severed {} connections and parted nothing: it passed through a part "
            "of the work-piece only, by its place, its width or its way",
            stage.name, totals.severed));
    }
    const bool keeps_energy =
        stage.sim.solver == Solver::explicit_steps || stage.sim.solver == Solver::energy_stepped;
    if (const double share = unaccounted(last, round_off(bodies));
        keeps_energy && std::abs(share) > kMostGain) {
        outcome.warning.push_back(fmt::format(
            "{}: the energy books do not close: {:.2g} % of the energy in play is {}; try a lower "
            "step_safety, more cells, or, where bodies are pressed deep into each other, a larger "
            "contact_stiffness",
            stage.name, 100 * std::abs(share), share > 0 ? "lost" : "from nowhere"));
    }
    double overlap = 0;  // [m]
    const bool meets = stage.sim.self_contact;
    if (stage.sim.solver == Solver::quasistatic && (last.pieces == 1 || meets) &&
        !outcome.interrupted) {
        Aggregate& body = bodies.front().matter;
        overlap = own_overlap(body);
        if (overlap > kOverlap * body.lattice.spacing) {
            outcome.warning.push_back(
                fmt::format("{}: the work-piece has gone into itself, by {} at the end: {}",
                            stage.name, length_text(overlap),
                            meets ? "it is pressed together harder than its contact_stiffness holds"
                                  : "self_contact = true in this stage keeps it from that"));
        }
    }
    outcome.steps = totals.iterations + totals.steps;
    Json by_body = Json::array();
    for (const Books& books : last.body) by_body.push_back(energies_json(books));
    outcome.record = {
        {"name", stage.name},
        {"machine", stage.machine.name},
        {"parameters", parameters_json(machine)},
        {"frames", {first_frame, last_frame + static_cast<int>(curves.rows()) - 1}},
        {"legs", legs.leg.size()},
        {"duration_s", duration},
        {"remolded", stage.remold},
        {"particles", particle_count(bodies)},
        {"connections_before", connections_before},
        {"connections_after", connection_count(bodies)},
        {"severed", totals.severed},
        {"broken", totals.broken},
        {"pieces", last.pieces},
        {"iterations", totals.iterations},
        {"increments", totals.increments},
        {"halvings", totals.halvings},
        {"solver", name_of(stage.sim.solver)},
        {"steps", totals.steps},
        {"steps_implicit_instead", totals.rescued},
        {"steps_rejected", totals.rejected},
        {"bodies_asleep", last.asleep},
        {"shortest_step_s", totals.shortest_step},
        {"largest_residual", totals.residual},
        {"deepest_penetration_m", totals.penetration},
        {"own_overlap_m", overlap},
        {"energies_J", energies_json(last)},
        {"energies_by_body_J", by_body},
        {"notes", machine.notes},
        {"warnings", outcome.warning},
        {"state_hash", hash_text(state_hash(bodies))},
    };
    return outcome;
}

}  // namespace swage
