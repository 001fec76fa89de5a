// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/portable_math.h"
#include "base/text.h"
#include "base/whole.h"
#include "laws/spring_moduli.h"
#include "machines/legs.h"
#include "mold/prepare.h"
#include "pipeline/accuracy.h"
#include "pipeline/carried_insets.h"
#include "pipeline/counted_matter.h"
#include "pipeline/disk_cost.h"
#include "pipeline/folded_bodies.h"
#include "pipeline/free_room.h"
#include "pipeline/memory_cost.h"
#include "pipeline/rounded_text.h"
#include "pipeline/stage_machine.h"
#include "pipeline/start_flight.h"
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
constexpr double kPointsPerFace = 4;       // of contact
constexpr double kParticlesForTwo = 2048;  // from which on a second core helps
constexpr double kVerticesPerFace = 6;     // of a boundary, a cell's face: four, and its steps
// Triangles that one becomes whose sides are halved to p, q and r parts, over (p q r)^(2/3); none
// is smaller than as makes so many vertices of a square of the longest edge.
constexpr double kDividedTriangles = 1.17, kMostDividedVertices = 5.625;
// Addresses beside that memory and those of threads.
constexpr double kDrawingAddresses = 550e6;
constexpr double kLongestRun = 30 * 86400.0;
constexpr double kFarMore = 10;  // steps than explicit ones
// Cells, over those that are to be counted, before it is given up: of so few a body may have no
// matter, and a machine's part no hold.
constexpr double kCountedInVain = 10;
constexpr double kWorthTelling = 0.05;  // of a stage, that is free flight
// Of a full lattice: neither slivers nor damping, which takes up to 4 times as many.
constexpr double kStepsPerCrossing = 2.1;

// What a cell's fastest swing takes, that of pressure waves (P-wave modulus).
double lattice_steps_per_second(const BodySpec& body, double spacing, const SimSettings& sim) {
    double wave_speed = 0;
    for (const Material* m : body.materials()) {
        const bool springs = body.material.mechanics == Mechanics::springs;
        const double nu = springs ? kPoissonOfSprings : m->poisson_ratio;
        const double modulus = m->young_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
        wave_speed = std::max(wave_speed, std::sqrt(modulus / m->density));
    }
    return kStepsPerCrossing * wave_speed / spacing / sim.step_safety;
}

// Of a mesh as it is mounted, divided where its edges are longer than so many spacings.
double mounted_vertices(const TriMesh& mesh, std::optional<double> longest_edge, double spacing) {
    double vertices = static_cast<double>(mesh.position.size());
    if (!longest_edge) return vertices;
    const double longest = *longest_edge * spacing;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        const Vec3 u = mesh.position[b] - mesh.position[a], v = mesh.position[c] - mesh.position[a];
        double parts = 1;
        for (double side : {u.norm(), v.norm(), (v - u).norm()}) {
            for (; side > longest; side /= 2) parts *= 2;
        }
        if (parts == 1) continue;
        const double most = kMostDividedVertices * 0.5 * u.cross(v).norm() / (longest * longest);
        const double made = 0.5 * (kDividedTriangles * portable::pow(parts, 2. / 3) - 1);
        vertices += std::min(std::max(most, 0.5), made);
    }
    return vertices;
}

// Those of the work-piece may go on with it.
void add_insets(const SceneSpec& scene, const std::vector<std::vector<TriMesh>>& insets,
                double spacing, MemoryShare& share) {
    for (const std::vector<TriMesh>& body : insets) {
        for (const TriMesh& one : body) {
            share.inset_triangles += static_cast<double>(one.triangle.size());
        }
    }
    if (!carries_insets(scene, 0)) return;
    for (const TriMesh& one : insets.front()) {
        share.carried_vertices += mounted_vertices(one, kLongestSkinEdge, spacing);
    }
}

// Of the body with the shortest stable step. `counted`: or null.
double steps_per_second(const SceneSpec& scene, const RunCost& cost, const CountedMatter* counted,
                        const StageSpec& stage) {
    double most = 0;
    for (std::size_t b = 0; b < scene.body.size(); ++b) {
        most = std::max(
            most, counted != nullptr
                      ? counted->steps_per_second(b, stage)
                      : lattice_steps_per_second(scene.body[b], cost.body[b].spacing, stage.sim));
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

// As much as this many cells of the work-piece pressed as tools do.
double softest_give(const SceneSpec& scene, const std::vector<InputMesh>& input,
                    const CountedMatter* counted) {
    double most = 0;
    for (const StageSpec& stage : scene.stage) {
        if (stage.machine.tool.empty()) continue;
        const double share =
            counted == nullptr ? 1 : stiffness_share_at_tools(stage, counted->named(scene, input));
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
        const auto takes_more = [&](const StageSpec& stage) {
            return stage.sim.solver == solver && more_steps(scene, stage) >= kFarMore;
        };
        const auto first = std::find_if(scene.stage.begin(), scene.stage.end(), takes_more);
        if (first == scene.stage.end()) continue;
        const double more = more_steps(scene, *first);
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

// What is known of the first stage alone.
struct FirstStage {
    long equilibria = 0;           // 0: not known
    double flight = 0;             // [s]
    std::vector<double> leg = {};  // in motion, where frames are few [s]
};

// `counted`: or null.
void add_up(RunCost& cost, const SceneSpec& scene, const std::vector<InputMesh>& input,
            const RunOptions& options, const CountedMatter* counted, const FirstStage& first) {
    cost.frames = frame_count(scene);
    cost.tool_give = softest_give(scene, input, counted);
    cost.steps = cost.seconds = {};
    double way = 0;  // [byte], of the machine's, one after another
    WorkLoad load{.particles = cost.mold.particles,
                  .longest = double(cost.mold.cell_count.maxCoeff()),
                  .thickness = cost.work_piece().thickness};
    for (std::size_t b = 0; b < input.size(); ++b) {
        const double a = cost.body[b].spacing;
        load.surface_points += kPointsPerFace * surface_area(input[b].to_mold()) / (a * a);
    }
    for (const StageSpec& stage : scene.stage) {
        const bool moves = in_motion(stage.sim.solver);
        way = std::max(way, bytes_of_way(stage.machine, stage.frames, moves));
        if (moves) load.steps_per_second = steps_per_second(scene, cost, counted, stage);
        const bool is_first = &stage == &scene.stage.front();
        load.flight = is_first ? first.flight : 0;
        load.leg = is_first ? first.leg : std::vector<double>();
        const StageTime time = stage_time(scene, stage, load, is_first ? first.equilibria : 0);
        cost.steps.add(time.steps);
        cost.seconds.add(time.seconds);
    }
    double vertices = 0;
    for (std::size_t b = 0; b < input.size(); ++b) {
        vertices +=
            scene.skin.kind == SkinKind::boundary
                ? kVerticesPerFace * surface_area(input[b].to_mold()) /
                      (cost.body[b].spacing * cost.body[b].spacing)
                : mounted_vertices(input[b].mesh, scene.skin.longest_edge, cost.body[b].spacing);
    }
    double stills = options.draw ? cost.frames : 0;
    if (options.draw && options.frames) stills = options.frames->last - options.frames->first + 1;
    MemoryShare share = {cost.mold.bytes,
                         cost.mold.particles,
                         cost.mold.active_cells,
                         load.surface_points / kPointsPerFace,
                         cut_faces(scene, input[0].to_mold(), cost.work_piece().spacing),
                         vertices,
                         way};
    if (counted != nullptr) add_insets(scene, counted->inset, cost.work_piece().spacing, share);
    const MemoryBytes memory = memory_bytes(scene, input, share, stills > 0);
    cost.memory_bytes = memory.about;
    cost.most_memory_bytes = memory.most;
    cost.undrawn_memory_bytes = memory.undrawn;
    cost.less_memory = memory.less;
    const DiskShare disk = {double(cost.frames),    stills,
                            cost.mold.active_cells, cost.mold.particles,
                            cost.mold.bytes,        vertices,
                            cost.seconds.most,      load.surface_points / kPointsPerFace};
    cost.disk_bytes = disk_bytes(scene, input, disk);
    cost.least_disk_bytes = least_disk_bytes(scene, input, disk);
    const double drawing = drawing_time(scene.render, stills);
    cost.seconds.add(writing_time(scene, cost.frames, {cost.least_disk_bytes, cost.disk_bytes},
                                  cost.mold.particles));
    cost.hangs_on = cost.seconds.is_narrow() ? "" : what_time_hangs_on(scene);
    cost.seconds.add({0.6 * drawing, 1.2 * drawing});
    // What is small, or goes from one equilibrium to the next, has little for more of them.
    const double cores = std::min(thread_count(), 2);
    cost.seconds.least /= cores;
    if (cost.mold.particles > kParticlesForTwo) cost.seconds.most /= std::sqrt(cores);
}

// Of the bodies' meshes and of their strength.
void add_warnings(const SceneSpec& scene, const std::vector<InputMesh>& input, RunCost& cost) {
    const std::vector<std::string> name = body_names(scene);
    cost.warning.mesh = warnings_of_meshes(scene, input);
    std::vector<std::vector<std::string>> strength(scene.body.size());
    const std::string section = "[mold]";
    for (std::size_t b = 0; b < scene.body.size(); ++b) {
        const BodyCost& body = cost.body[b];
        for (const Material* material : scene.body[b].materials()) {
            Advisable most{.across = body.most_across};
            const auto known = scene.strange_toughness.find(material->name);
            if (known != scene.strange_toughness.end()) most.toughness = known->second;
            const std::string one =
                strength_warning(*material, body.spacing, body.across, section, most);
            if (!one.empty()) strength[b].push_back(one);
        }
    }
    for (FoldedText& one : folded(strength)) {
        const std::size_t at = one.text.find(section), first = one.body.front();
        if (first > 0 && at != std::string::npos) {
            one.text.replace(at, section.size(), fmt::format("[[body]] \"{}\"", name[first]));
        }
        if (one.body.size() > 1) one.text += fmt::format(" ({})", bodies_text(name, one.body));
        cost.warning.strength.push_back(std::move(one.text));
    }
}

MoldEstimate sum_of(const std::vector<MoldEstimate>& bodies) {
    MoldEstimate sum = bodies.front();
    for (std::size_t b = 1; b < bodies.size(); ++b) {
        sum.active_cells += bodies[b].active_cells;
        sum.particles += bodies[b].particles;
        sum.connections += bodies[b].connections;
        sum.bytes += bodies[b].bytes;
    }
    return sum;
}

long equilibria_of(const StageSpec& first, const Machine& machine, const CountedMatter& counted,
                   double spacing, const Legs& legs) {
    const std::vector<Drive> drives = stage_drives(first, machine, legs.leg, 1);
    const auto along = [&](const Aggregate& matter) {
        return std::max<long>(first.frames,
                              equilibria_along(matter, machine.apparatus, first.sim, drives));
    };
    if (counted.coarser[0] == 1) return along(counted.matter[0]);
    // NOTE: no tool goes further than a cell from one to the next: for that alone its size counts.
    Aggregate finer = counted.matter[0];
    finer.lattice.spacing = spacing;
    return along(finer);
}

// The matter, and the first machine at it.
void count(RunCost& cost, const SceneSpec& scene, const std::vector<InputMesh>& input,
           const RunOptions& options, std::vector<MoldEstimate> mold,
           const std::vector<double>& coarser) {
    const CountedMatter made = make_matter(scene, input, mold, coarser, cost.warning.mold);
    cost.counted = made.is_whole();
    for (std::size_t b = 0; b < input.size(); ++b) {
        mold[b] = counted(made.matter[b], input[b], scene.body[b].mold, mold[b], coarser[b]);
        cost.body[b].cells = mold[b].active_cells;
    }
    cost.mold = sum_of(mold);
    const std::vector<NamedMatter> bodies = made.named(scene, input);
    cost.warning.bodies = warnings_of_bodies(scene, bodies);
    const std::string steps = step_note(scene, made);
    if (!steps.empty()) cost.note.push_back(steps);
    const StageSpec& first = scene.stage.front();
    const std::vector<Material> beside = materials_beside(bodies);
    const Box skin = bodies.front().skin;
    const Aggregate& work_piece = made.matter.front();
    const double coarse = made.coarser.front();
    const Machine machine = stage_machine(first, work_piece, beside, skin, coarse);
    cost.place = machine_places(scene, machine, work_piece, beside, skin, coarse);
    cost.note.insert(cost.note.end(), machine.notes.begin(), machine.notes.end());
    for (std::string& amiss : tool_overlaps(machine, bodies, in_motion(first.sim.solver))) {
        cost.warning.bodies.push_back(std::move(amiss));
    }
    for (const StageSpec& stage : scene.stage) {
        const std::string note = stiffness_note(stage, bodies);
        if (!note.empty()) cost.warning.bodies.push_back(stage.name + ": " + note);
    }
    const double flight =
        start_flight(first, machine, bodies, 1 / steps_per_second(scene, cost, &made, first));
    if (flight > kWorthTelling * first.duration) {
        cost.note.push_back(fmt::format("{}: free flight for the first {} takes next to no steps",
                                        first.name, rounded_text(flight, Quantity::time, 3)));
    }
    // As straight as the spacing that is asked for has it.
    const double spacing = cost.work_piece().spacing;
    const Legs legs = stage_legs(first, machine, std::min(first.frames, kSampledFrames), spacing);
    FirstStage of_first{.flight = flight};
    if (!in_motion(first.sim.solver)) {
        of_first.equilibria = equilibria_of(first, machine, made, spacing, legs);
    } else if (first.frames <= kSampledFrames) {
        for (const Leg& leg : legs.leg) {
            of_first.leg.push_back((leg.end - leg.begin) * first.duration);
        }
    }
    add_up(cost, scene, input, options, &made, of_first);
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
    std::vector<MoldEstimate> mold;
    for (std::size_t b = 0; b < input.size(); ++b) {
        try {
            refuse_too_many_cells(input[b].to_mold(), scene.body[b].mold);
        } catch (const FinenessError& error) {
            refuse_fineness(scene.body[b], error);
        }
        mold.push_back(estimate_mold(input[b].to_mold(), scene.body[b].mold));
        const double across =
            cells_across(input[b].to_mold(), scene.body[b].mold.kind, mold.back());
        cost.body.push_back({mold[b].spacing, mold[b].active_cells, across,
                             thickness_of(input[b].to_mold(), mold[b].spacing, across), 0});
        const double box = mold[b].cell_count.cast<double>().prod();
        const auto limit = static_cast<double>(scene.body[b].mold.cell_limit);
        cost.body[b].most_across = std::floor(across * portable::pow(limit / box, 1. / 3));
    }
    add_warnings(scene, input, cost);
    cost.mold = sum_of(mold);
    add_up(cost, scene, input, options, nullptr, {});
    note_more_steps(scene, cost);
    return cost;
}

RunCost count_cost(const SceneSpec& scene, const std::vector<InputMesh>& input,
                   const RunOptions& options, double most) {
    const RunCost estimate = estimate_cost(scene, input, options);
    if (scene.stage.empty()) return estimate;
    std::vector<MoldEstimate> mold;
    std::vector<double> across;
    for (std::size_t b = 0; b < input.size(); ++b) {
        mold.push_back(estimate_mold(input[b].to_mold(), scene.body[b].mold));
        across.push_back(estimate.body[b].across);
    }
    for (const bool again : {false, true}) {
        const std::vector<double> coarser =
            coarser_by(mold, across, again ? kCountedInVain * most : most);
        const bool is_whole = *std::max_element(coarser.begin(), coarser.end()) == 1;
        try {
            RunCost cost = estimate;
            count(cost, scene, input, options, mold, coarser);
            return cost;
        } catch (const Error& error) {
            // Ranges and notes go by the cells that are asked for; what else a machine has against
            // such different ones it has against any.
            if (is_whole || (again && error.code() == ExitCode::scene)) throw;
        }
    }
    return estimate;
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
            {"memory_bytes_most", cost.most_memory_bytes},
            {"memory_bytes_undrawn", cost.undrawn_memory_bytes},
            {"disk_bytes", cost.disk_bytes},
            {"disk_bytes_least", cost.least_disk_bytes},
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
        fail(
            ExitCode::resources,
            "the run would need about {} of memory, and {} is free: {} needs less (--force runs it "
            "anyway)",
            bytes_text(cost.memory_bytes), bytes_text(memory), cost.less_memory);
    }
    const double addresses = cost.memory_bytes + kThreadAddresses * thread_count() +
                             (options.draw ? kDrawingAddresses : 0);
    if (addresses > free_addresses()) {
        fail(ExitCode::resources,
             "the run would need about {} of address space, and its limit (ulimit -v) leaves {}: "
             "--no-render and fewer --threads need less (--force runs it anyway)",
             bytes_text(addresses), bytes_text(free_addresses()));
    }
    if (cost.least_disk_bytes > disk) {
        fail(ExitCode::resources,
             "the run would write at least {}, and {} of disk is free: fewer frames or a smaller "
             "[render] size need less (--force runs it anyway)",
             bytes_text(cost.least_disk_bytes), bytes_text(disk));
    }
    if (cost.seconds.least > kLongestRun) {
        fail(
            ExitCode::resources,
            "the run would take at least {:.0f} days: a larger [mold] spacing and fewer frames, in "
            "motion a shorter duration, take less (--force runs it anyway)",
            cost.seconds.least / 86400);
    }
}

}  // namespace swage
