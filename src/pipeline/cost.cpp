// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/whole.h"
#include "machines/legs.h"
#include "pipeline/accuracy.h"
#include "pipeline/disk_cost.h"
#include "pipeline/free_room.h"
#include "pipeline/probes.h"
#include "pipeline/stage_machine.h"
#include "pipeline/start_overlap.h"
#include "pipeline/stiffness_note.h"
#include "sim/advance.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr int kSampledFrames = 200;        // of the first stage, for how far its tools go
constexpr double kWhole = 0.01;            // of a layer of cells: less is as good as whole
constexpr double kManyLayers = 20;         // of which the outermost hardly count
constexpr double kThin = 0.3;              // of the box's thinnest side
constexpr double kBytesPerParticle = 500;  // beside the aggregate: solver, mount, skin
constexpr double kBytesPerVertex = 600;
constexpr double kPointsPerFace = 4;       // of contact
constexpr double kParticlesForTwo = 2048;  // from which on a second core helps
constexpr double kVerticesPerFace = 6;     // of a boundary, a cell's face: four, and its steps
constexpr double kDividedVerticesPerFace = 2.5;  // of a face that is divided to follow the matter
constexpr double kProgramBytes = 80e6, kDrawingBytes = 65e6;  // libraries and their buffers
// Addresses beside that memory and those of threads.
constexpr double kDrawingAddresses = 550e6;
constexpr double kLongestRun = 30 * 86400.0;
constexpr double kFarShorter = 4;          // a step than a body needs
constexpr double kFarMore = 10;            // steps than explicit ones
constexpr double kCountedCells = 300'000;  // molded for real by count_cost

// The stable step of a full lattice: neither slivers nor damping.
double lattice_steps_per_second(const BodySpec& body, double spacing, const SimSettings& sim) {
    double wave_speed = 0;
    for (const Material* m : body.materials()) {
        wave_speed = std::max(wave_speed, std::sqrt(m->young_modulus / m->density));
    }
    return 2.5 * wave_speed / spacing / sim.step_safety;
}

// Of a mesh as it is mounted, divided where its edges are long.
double mounted_vertices(const TriMesh& mesh, const SkinSettings& skin, double spacing) {
    double vertices = static_cast<double>(mesh.position.size());
    for (std::size_t t = 0; skin.divide && t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        const Vec3 u = mesh.position[b] - mesh.position[a], v = mesh.position[c] - mesh.position[a];
        const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
        if (longest <= kLongestSkinEdge * spacing) continue;
        vertices += kDividedVerticesPerFace * 0.5 * u.cross(v).norm() / (spacing * spacing);
    }
    return vertices;
}

// Of the body with the shortest stable step.
double steps_per_second(const SceneSpec& scene, const RunCost& cost,
                        const std::vector<Aggregate>& matter, const SimSettings& sim) {
    double most = 0;
    for (const Aggregate& body : matter)
        most = std::max(most, explicit_steps_per_second(body, sim));
    if (matter.empty()) {
        for (std::size_t b = 0; b < scene.body.size(); ++b) {
            most =
                std::max(most, lattice_steps_per_second(scene.body[b], cost.body[b].spacing, sim));
        }
    }
    return most;
}

// Of walls 2 V / A; of a bar or ball half of how thick it is, or a third.
double thickness_of(const TriMesh& mesh, double spacing, double across) {
    const double mean = 2 * std::abs(signed_volume(mesh)) / surface_area(mesh) / spacing;
    return mean < kThin * across ? mean : across;
}

// A block is of whole cells, whatever its mesh is.
double cells_across(const TriMesh& mesh, MoldKind kind, const MoldEstimate& mold) {
    constexpr double kRounding = 1e-6;
    const double layers = mold.cell_count.minCoeff();
    const double across = box_of(mesh.position).size().minCoeff() / mold.spacing;
    return kind == MoldKind::block || across > layers - kRounding ? layers : across;
}

std::vector<NamedMatter> named(const SceneSpec& scene, const std::vector<InputMesh>& input,
                               const std::vector<Aggregate>& matter) {
    std::vector<NamedMatter> named;
    for (std::size_t b = 0; b < matter.size(); ++b) {
        const BodySpec& body = scene.body[b];
        const bool is_mesh = scene.skin.kind != SkinKind::boundary;
        const TriMesh& shown = is_mesh ? input[b].mesh : input[b].to_mold();
        named.push_back(
            {body.name, &matter[b], box_at_start(body.start, input[b].to_mold(), shown)});
    }
    return named;
}

// As much as this many cells of the work-piece pressed as tools do.
double softest_give(const SceneSpec& scene, const std::vector<InputMesh>& input,
                    const std::vector<Aggregate>& matter) {
    double most = 0;
    for (const StageSpec& stage : scene.stage) {
        if (stage.machine.tool.empty()) continue;
        const double share =
            matter.empty() ? 1 : stiffness_share_at_tools(stage, named(scene, input, matter));
        for (const ToolSpec& tool : stage.machine.tool) {
            const double asked = stage.sim.stiffness_of_contacts(tool.contact_stiffness);
            most = std::max(most, 1 / (asked * share));
        }
    }
    return most;
}

// Of the stages that take far more steps than explicit ones would, those with the same solver as
// one.
void note_more_steps(const SceneSpec& scene, RunCost& cost) {
    for (const Solver solver : {Solver::energy_stepped, Solver::euler}) {
        const double more = more_steps(scene, solver);
        const auto by = [&](const StageSpec& stage) { return stage.sim.solver == solver; };
        const auto first = std::find_if(scene.stage.begin(), scene.stage.end(), by);
        if (first == scene.stage.end() || more < kFarMore) continue;
        cost.note.push_back(fmt::format(
            "{}: solver = \"{}\" takes about {:.0f} times as many steps as \"explicit\"{}",
            first->name, name_of(solver), more,
            solver == Solver::energy_stepped ? " while anything vibrates, rotates or is driven"
                                             : ""));
    }
}

std::string what_time_hangs_on(const SceneSpec& scene) {
    const bool has_tools =
        scene.any_stage([](const StageSpec& stage) { return !stage.machine.tool.empty(); });
    std::vector<std::string> all;
    if (scene.breaks()) all.push_back("fracture");
    if (scene.yields()) all.push_back("plastic flow");
    if (scene.moves()) {
        all.push_back("contact");
    } else if (has_tools) {
        all.push_back("slip");
    }
    return all.empty() ? "how soon it comes to rest" : joined(all, " and ");
}

// `matter`: of each body, or empty. `equilibria`: of the first stage, 0: not known.
void add_up(RunCost& cost, const SceneSpec& scene, const std::vector<InputMesh>& input,
            const RunOptions& options, const std::vector<Aggregate>& matter, long equilibria) {
    cost.frames = frame_count(scene);
    cost.tool_give = softest_give(scene, input, matter);
    cost.steps = cost.seconds = {};
    double way = 0;  // [byte], of the machine's, one after another
    WorkLoad load{.particles = cost.mold.particles,
                  .longest = double(cost.mold.cell_count.maxCoeff())};
    for (std::size_t b = 0; b < input.size(); ++b) {
        const double a = cost.body[b].spacing;
        load.surface_points += kPointsPerFace * surface_area(input[b].to_mold()) / (a * a);
    }
    for (const StageSpec& stage : scene.stage) {
        const bool moves = in_motion(stage.sim.solver);
        way = std::max(way, bytes_of_way(stage.machine, stage.frames, moves));
        if (moves) load.steps_per_second = steps_per_second(scene, cost, matter, stage.sim);
        const bool counted = &stage == &scene.stage.front();
        const StageTime time = stage_time(scene, stage, load, counted ? equilibria : 0);
        cost.steps.add(time.steps);
        cost.seconds.add(time.seconds);
    }
    const double pixels = static_cast<double>(scene.render.width) * scene.render.height;
    double vertices = 0;
    for (std::size_t b = 0; b < input.size(); ++b) {
        vertices += scene.skin.kind == SkinKind::boundary
                        ? kVerticesPerFace * surface_area(input[b].to_mold()) /
                              (cost.body[b].spacing * cost.body[b].spacing)
                        : mounted_vertices(input[b].mesh, scene.skin, cost.body[b].spacing);
    }
    double stills = options.draw ? cost.frames : 0;
    if (options.draw && options.frames) stills = options.frames->last - options.frames->first + 1;
    cost.memory_bytes = kProgramBytes + cost.mold.bytes + cost.mold.particles * kBytesPerParticle +
                        vertices * kBytesPerVertex + way +
                        (options.draw ? kDrawingBytes + pixels * 60 : 0);
    cost.disk_bytes =
        disk_bytes(scene, input,
                   {double(cost.frames), stills, cost.mold.active_cells, cost.mold.particles,
                    cost.mold.bytes, vertices, cost.seconds.most});
    const double drawing = drawing_time(scene.render, stills);
    cost.seconds.add(writing_time(scene, cost.frames, cost.disk_bytes, cost.mold.particles));
    cost.hangs_on = cost.seconds.is_narrow() ? "" : what_time_hangs_on(scene);
    cost.seconds.add({0.6 * drawing, 1.2 * drawing});
    // What is small, or goes from one equilibrium to the next, has little for more of them.
    const double cores = std::min(thread_count(), 2);
    cost.seconds.least /= cores;
    if (cost.mold.particles > kParticlesForTwo) cost.seconds.most /= std::sqrt(cores);
}

// Of a body's mesh and of its strength.
void add_warnings(const SceneSpec& scene, std::size_t b, const InputMesh& input, RunCost& cost) {
    StartWarnings& told = cost.warning;
    told.mesh.insert(told.mesh.end(), input.finding.begin(), input.finding.end());
    const std::string section =
        b == 0 ? "[mold]" : fmt::format("[[body]] \"{}\"", scene.body[b].name);
    for (const Material* material : scene.body[b].materials()) {
        const std::string strength =
            strength_warning(*material, cost.body[b].spacing, cost.body[b].across, section);
        // Bodies and insets may be of one material.
        const bool known =
            std::find(told.strength.begin(), told.strength.end(), strength) != told.strength.end();
        if (!strength.empty() && !known) told.strength.push_back(strength);
    }
}

}  // namespace

int BodyCost::whole_layers() const {
    const double nearest = std::max(1.0, std::round(across));
    return std::abs(across - nearest) < kWhole || across > kManyLayers ? 0 : to_int(nearest);
}

double BodyCost::outermost_fill() const { return 0.5 * (across - (std::ceil(across) - 2)); }

int frame_count(const SceneSpec& scene) {
    long frames = 1;
    for (const StageSpec& stage : scene.stage) frames += stage.frames;
    return static_cast<int>(std::min<long>(frames, std::numeric_limits<int>::max()));
}

RunCost estimate_cost(const SceneSpec& scene, const std::vector<InputMesh>& input,
                      const RunOptions& options) {
    RunCost cost;
    for (std::size_t b = 0; b < input.size(); ++b) {
        const MoldEstimate mold = estimate_mold(input[b].to_mold(), scene.body[b].mold);
        const double across = cells_across(input[b].to_mold(), scene.body[b].mold.kind, mold);
        cost.body.push_back({mold.spacing, mold.active_cells, across,
                             thickness_of(input[b].to_mold(), mold.spacing, across)});
        add_warnings(scene, b, input[b], cost);
        if (b == 0) {
            cost.mold = mold;
            continue;
        }
        cost.mold.active_cells += mold.active_cells;
        cost.mold.particles += mold.particles;
        cost.mold.connections += mold.connections;
        cost.mold.bytes += mold.bytes;
    }
    add_up(cost, scene, input, options, {}, 0);
    note_more_steps(scene, cost);
    return cost;
}

RunCost count_cost(const SceneSpec& scene, const std::vector<InputMesh>& input,
                   const RunOptions& options) {
    RunCost cost = estimate_cost(scene, input, options);
    if (cost.mold.active_cells > kCountedCells || scene.stage.empty()) return cost;
    std::vector<Aggregate> matter;
    cost.counted = true;
    cost.mold.active_cells = cost.mold.particles = cost.mold.connections = cost.mold.bytes = 0;
    for (std::size_t b = 0; b < input.size(); ++b) {
        const BodySpec& body = scene.body[b];
        std::vector<std::string> findings;
        matter.push_back(mold_body(input[b], body, findings));
        for (const std::string& warning : warnings_of_mold(body.name, input.size() > 1, findings)) {
            cost.warning.mold.push_back(warning);
        }
        mount_probes(body, input[b].to_mold(), matter[b]);  // refuses those beside it
        place_at_start(body.start, input[b].to_mold(), matter[b]);
        cost.body[b].cells = static_cast<double>(matter[b].cell_fill.size());
        cost.mold.active_cells += cost.body[b].cells;
        cost.mold.particles += static_cast<double>(matter[b].particle_count());
        cost.mold.connections += static_cast<double>(matter[b].connection_count());
        cost.mold.bytes += static_cast<double>(matter[b].bytes());
    }
    const std::vector<NamedMatter> bodies = named(scene, input, matter);
    cost.warning.bodies = warnings_of_bodies(scene, bodies);
    const std::string steps = step_note(scene, matter);
    if (!steps.empty()) cost.note.push_back(steps);
    const StageSpec& first = scene.stage.front();
    const std::vector<Material> beside = materials_beside(bodies);
    const Box skin = bodies.front().skin;
    const Machine machine = stage_machine(first, matter[0], beside, skin);
    cost.place = machine_places(scene, machine, matter[0], beside, skin);
    cost.note.insert(cost.note.end(), machine.notes.begin(), machine.notes.end());
    for (std::string& amiss : tool_overlaps(machine, bodies, in_motion(first.sim.solver))) {
        cost.warning.bodies.push_back(std::move(amiss));
    }
    for (const StageSpec& stage : scene.stage) {
        const std::string note = stiffness_note(stage, bodies);
        if (!note.empty()) cost.warning.bodies.push_back(stage.name + ": " + note);
    }
    const Legs legs = stage_legs(first, machine, std::min(first.frames, kSampledFrames), matter[0]);
    const long equilibria =
        in_motion(first.sim.solver)
            ? 0
            : std::max<long>(first.frames,
                             equilibria_along(matter[0], machine.apparatus, first.sim,
                                              stage_drives(first, machine, legs.leg, 1)));
    add_up(cost, scene, input, options, matter, equilibria);
    return cost;
}

std::string step_note(const SceneSpec& scene, const std::vector<Aggregate>& matter) {
    for (const StageSpec& stage : scene.stage) {
        const Solver solver = stage.sim.solver;
        if (!follows_all_motion(solver)) continue;
        std::vector<double> steps;
        for (const Aggregate& body : matter) {
            steps.push_back(explicit_steps_per_second(body, stage.sim));
        }
        const auto most = std::max_element(steps.begin(), steps.end());
        std::string others;
        for (std::size_t b = 0; b < steps.size(); ++b) {
            if (*most < kFarShorter * steps[b]) continue;
            others += fmt::format("{}{} {:.0f} times", others.empty() ? "" : ", ",
                                  scene.body[b].name, *most / steps[b]);
        }
        if (others.empty()) continue;
        return fmt::format(
            "all steps are as short as {} needs, others would allow longer ones: {}; larger cells "
            "there, or a lower young_modulus that is still stiff beside theirs, take less time",
            scene.body[std::size_t(most - steps.begin())].name, others);
    }
    return {};
}

Json cost_json(const RunCost& cost) {
    Json bodies = Json::array();
    for (const BodyCost& body : cost.body) {
        bodies.push_back({{"spacing_m", body.spacing},
                          {"cells", body.cells},
                          {"thickness_cells", body.thickness},
                          {"across_cells", body.across},
                          {"whole_layers", body.whole_layers()}});
    }
    return {{"counted", cost.counted},
            {"spacing_m", cost.mold.spacing},
            {"cells", cost.mold.active_cells},
            {"particles", cost.mold.particles},
            {"connections", cost.mold.connections},
            {"matter_bytes", cost.mold.bytes},
            {"memory_bytes", cost.memory_bytes},
            {"disk_bytes", cost.disk_bytes},
            {"frames", cost.frames},
            {"steps", cost.steps.middle()},
            {"steps_least", cost.steps.least},
            {"steps_most", cost.steps.most},
            {"seconds", cost.seconds.middle()},
            {"seconds_least", cost.seconds.least},
            {"seconds_most", cost.seconds.most},
            {"time_hangs_on", cost.hangs_on},
            {"thickness_cells", cost.work_piece().thickness},
            {"bodies", bodies},
            {"tool_give_cells", cost.tool_give},
            {"notes", cost.note},
            {"warnings", cost.warning.all()}};
}

void refuse_excess(const RunCost& cost, const RunOptions& options) {
    if (options.insist) return;
    const double memory = free_memory(), disk = free_disk(fs::absolute(options.out));
    if (cost.memory_bytes > memory) {
        fail(ExitCode::resources,
             "the run would need about {} of memory, and {} is free: a larger [mold] spacing needs "
             "less (--force runs it anyway)",
             bytes_text(cost.memory_bytes), bytes_text(memory));
    }
    const double addresses = cost.memory_bytes + kThreadAddresses * thread_count() +
                             (options.draw ? kDrawingAddresses : 0);
    if (addresses > free_addresses()) {
        fail(ExitCode::resources,
             "the run would need about {} of address space, and its limit (ulimit -v) leaves {}: "
             "--no-render and fewer --threads need less (--force runs it anyway)",
             bytes_text(addresses), bytes_text(free_addresses()));
    }
    if (cost.disk_bytes > disk) {
        fail(ExitCode::resources,
             "the run would write about {}, and {} of disk is free: fewer frames or a smaller "
             "[render] size need less (--force runs it anyway)",
             bytes_text(cost.disk_bytes), bytes_text(disk));
    }
    if (cost.seconds.least > kLongestRun) {
        fail(ExitCode::resources,
             "the run would take at least {:.0f} days: fewer frames or a larger [mold] spacing "
             "take less (--force runs it anyway)",
             cost.seconds.least / 86400);
    }
}

}  // namespace swage
