// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers are measured on one core of a shared Xeon, by what `swage run --no-render` took and
// the steps, iterations and equilibria that run.json then told; tests/verify/COSTS.md has a table
// of what was told and what came.
#include "pipeline/time_cost.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "laws/spring_moduli.h"

namespace swage {

namespace {

// What others do on the machine, and how the matter lies in its caches.
constexpr CostRange kMachine = {0.6, 1.7};

// Of an explicit step [s]: of each particle its cells and its move; its dashpots; its flow; of each
// point of the surface what drags it, what it has near of tools, and what it presses of bodies.
constexpr double kCells = 45e-9, kDashpots = 45e-9, kFlow = 30e-9;
constexpr double kFlowOfSprings = 350e-9;  // where all of it flows
constexpr double kDrag = 25e-9, kTools = 12e-9, kMeets = 60e-9;
// What is struck, by the energy of its motion over what it holds until it breaks or flows.
// Breaking: its springs, and all that is found anew after it (pieces, surfaces, what lies near),
// of each particle and step [s]; measured 0.16 to 0.7 of these.
constexpr CostRange kBreaking = {0.1e-6, 0.8e-6};
constexpr double kBreakingByMachines = 15e-6, kMostBreaking = 30e-6;
constexpr double kTakenBack = 1.1;  // steps, and those that are taken again
// Pieces that blades leave may be lighter than what was molded, which shortens steps: measured 1 to
// 1.01.
constexpr double kLighter = 1.1;
// Flow strikes cells flat, whose swings are faster: steps for one of the elastic body, beside it,
// at the most (a rod of copper 17 at 0.6, lumps of clay 4; what is never struck flat needs none).
constexpr double kFlattened = 35;
constexpr double kFlattenedByMachines = 10, kFlattest = 50;

// For each explicit step, those that energy chooses: while nothing damps, a swing holds them short.
// What is damped comes to rest, and damping shortens explicit steps, not these: measured 1.0 to 8.5
// where a machine stands (ratios of 0.005 to 0.3; what falls, strikes, spins), 5.5 to 17 where it
// drives.
constexpr CostRange kEnergySteps = {10, 200}, kDampedSteps = {0.9, 20}, kDrivenSteps = {3, 60};
constexpr double kLittleDamped = 0.005;   // a ratio below which it may swing as if nothing damped
constexpr double kImplicitSteps = 4;      // a frame, where no tool is in reach
constexpr double kImplicitAtTools = 200;  // times as many, where one is
constexpr CostRange kImplicitStep = {3e-6, 150e-6};  // of each particle [s]

// Under tools, or after a cut: iterations of relaxation an equilibrium, equilibria a frame where
// they are not counted, and what an iteration takes of a particle and a point of the surface [s].
// What is longer takes longer to settle: as (cells / kUsualLength)^kSettling; what may bend, which
// is slow, as its length over its thickness (80, 145, 250 and 485 an equilibrium at 20, 40, 80 and
// 160, the same of 1 to 3 layers); and all as the fastest swings, of pressure waves, are faster
// than E has them (1, 1.2, 1.9 and 4.2 times at a Poisson's ratio of 0, 0.3, 0.45 and 0.49).
constexpr CostRange kIterations = {35, 420}, kEquilibria = {1, 2.5};
// What blades cut that nothing has strained settles at once: 29 of the first stages that only cut
// took 9.1 to 15.4 iterations for each equilibrium that is counted.
constexpr CostRange kCutIterations = {9, 16};
// What takes most of its time is set up for each equilibrium, a particle [s]: 190 such stages took
// 2.7 to 20, half of them 5.3 to 10, with others on the machine.
constexpr CostRange kCutEquilibrium = {6e-6, 18e-6};
constexpr double kRelaxed = 75e-9, kRelaxedPoint = 15e-9;
constexpr double kUsualLength = 60, kSettling = 0.4;
constexpr double kUsualSlenderness = 20, kBending = 0.9;
constexpr double kUsualPoissonRatio = 0.3;
// Where nothing touches: of an equilibrium, each particle [s], by Newton's method, of which a step
// takes this; where much flows at once, or loads bend a body far, it gives up, and relaxation goes
// on.
constexpr CostRange kSmooth = {6e-6, 90e-6}, kYielding = {6e-6, 120e-6};
constexpr double kNewtonStep = 3.5e-6;
// A crack that runs is found again and again: equilibria for one where nothing breaks, under tools
// and where grips draw all of it.
constexpr double kCracking = 3, kCrackingAlong = 8;

constexpr double kSecondsPerByte = 20e-9;  // written
// Of each particle and frame, where skins are made anew.
constexpr CostRange kSkins = {0.3e-6, 15e-6};
constexpr double kSecondsPerStill = 0.04, kSecondsPerPixel = 3.6e-7;
// Of a pixel, where there are passes at all, and of each in order of PicturePass (stills of 3840 x
// 2160 took 2.5 s each, 8.4 with all passes).
constexpr double kSecondsPerLayers = 6e-8;
constexpr double kSecondsPerPass[] = {3e-8, 4e-8, 8e-8, 2e-7, 2.2e-7, 1e-7};

bool yields_as_springs(const SceneSpec& scene) {
    return scene.any_material(
        [](const Material& m) { return m.yields() && m.mechanics == Mechanics::springs; });
}

// Explicit steps for one of Euler's (sim/block_steps.cpp): dashpots damp the fastest swings of
// cells less the less their matter can be compressed, and shorten explicit steps only.
double euler_steps(const SceneSpec& scene) {
    double least = 1, largest = 0;
    for (const BodySpec& body : scene.body) {
        const bool has_cells = body.material.mechanics == Mechanics::cells;
        for (const Material* m : body.materials()) {
            const double damped = has_cells ? std::min(1.0, 2 * (1 - 2 * m->poisson_ratio)) : 1;
            least = std::min(least, m->damping_ratio * damped);
            largest = std::max(largest, m->damping_ratio);
        }
    }
    return (std::sqrt(1 + largest * largest) - largest) / std::max(least, 1e-6);
}

bool is_driven(const StageSpec& stage) {
    return !stage.machine.stands() || !stage.machine.load.empty();
}

CostRange energy_steps(const SceneSpec& scene, const StageSpec& stage) {
    if (!scene.damps()) return kEnergySteps;
    CostRange steps = is_driven(stage) ? kDrivenSteps : kDampedSteps;
    const bool may_swing =
        scene.any_material([](const Material& m) { return m.damping_ratio < kLittleDamped; });
    if (may_swing) steps.most = kEnergySteps.most;
    return steps;
}

// Of pressure waves' modulus, over Young's.
double wave_modulus(double nu) { return (1 - nu) / ((1 + nu) * (1 - 2 * nu)); }

// Iterations that an equilibrium takes at the most.
double most_iterations(const SceneSpec& scene, const WorkLoad& load) {
    double fastest = 0;
    for (const BodySpec& body : scene.body) {
        const bool has_cells = body.material.mechanics == Mechanics::cells;
        for (const Material* m : body.materials()) {
            const double nu = has_cells ? m->poisson_ratio : kPoissonOfSprings;
            fastest = std::max(fastest, wave_modulus(nu) / wave_modulus(kUsualPoissonRatio));
        }
    }
    const double slender = load.longest / std::max(1.0, load.thickness) / kUsualSlenderness;
    return kIterations.most * std::sqrt(std::max(1.0, fastest)) *
           std::max(1.0, portable::pow(load.longest / kUsualLength, kSettling)) *
           std::max(1.0, portable::pow(slender, kBending));
}

// The energy of motion with which a body strikes, in shares of what each cubic metre holds.
double struck(const Material& m, double speed, double holds) {
    return 0.5 * m.density * speed * speed / holds;
}
double held_until_breaking(const Material& m) {
    return 0.5 * m.strength * m.strength / m.young_modulus;
}

// How fast a body that starts slower may become [m/s].
double fastest(const SceneSpec& scene, const StageSpec& stage, double first) {
    const double gravity = stage.sim.gravity.norm();
    const double fall = gravity * stage.duration;
    const auto drop = stage.parameter.find("drop");
    const MachineSpec& machine = stage.machine;
    const bool only_falls = scene.body.size() == 1 && machine.upright && machine.stands() &&
                            machine.load.empty() && !stage.parameter.contains("slope");
    if (drop == stage.parameter.end() || !only_falls) return first + fall;
    return std::min(first + fall, std::sqrt(first * first + 2 * gravity * drop->second));
}

// How fast it surely comes to a tool below it [m/s].
double sure_speed(const SceneSpec& scene, const StageSpec& stage, const BodySpec& body) {
    if (stage.machine.tool.empty() || &stage != &scene.stage.front()) return 0;
    const Vec3 up = direction_of(stage.up == WorldAxis::automatic ? WorldAxis::y : stage.up);
    const double down = -body.start.velocity.dot(up);
    const auto drop = stage.parameter.find("drop");
    const bool arrives = drop == stage.parameter.end() || down * stage.duration > drop->second;
    return arrives ? std::max(0.0, down) : 0;
}

// Of the materials that break or flow. What flow makes of cells is never sure.
struct Strikes {
    CostRange breaking;
    double flowing = 0;  // at the most
};
Strikes strikes(const SceneSpec& scene, const StageSpec& stage) {
    Strikes found;
    const bool can_strike = !stage.machine.tool.empty() || scene.body.size() > 1;
    if (!can_strike) return found;
    for (const BodySpec& body : scene.body) {
        const double least = sure_speed(scene, stage, body);
        const double most = fastest(scene, stage, body.start.velocity.norm());
        for (const Material* m : body.materials()) {
            if (m->breaks()) {
                const double holds = held_until_breaking(*m), sure = struck(*m, least, holds);
                CostRange& breaking = found.breaking;
                breaking.least = std::max(breaking.least, sure > 1 ? sure : 0);
                breaking.most = std::max(breaking.most, struck(*m, most, holds));
            }
            if (m->yields()) {
                found.flowing = std::max(found.flowing, struck(*m, most, m->yield_stress));
            }
        }
    }
    return found;
}

// Whether nothing strains the matter until the end of the stage but what its blades do.
// NOTE: grips that only go along are taken to part what is cut, which strains nothing.
bool only_cuts(const SceneSpec& scene, const StageSpec& stage) {
    const auto turns = [](const GripSpec& grip) { return grip.motion.turn != "0"; };
    const auto strains = [&](const StageSpec& one) {
        const MachineSpec& machine = one.machine;
        return in_motion(one.sim.solver) || machine.blade.empty() || !machine.tool.empty() ||
               !machine.load.empty() || one.sim.gravity != Vec3::Zero() || one.sim.self_contact ||
               std::any_of(machine.grip.begin(), machine.grip.end(), turns);
    };
    const StageSpec* first = scene.stage.data();
    return scene.body.size() == 1 && !scene.breaks() && std::none_of(first, &stage + 1, strains);
}

StageTime relaxed(const SceneSpec& scene, const StageSpec& stage, const WorkLoad& load,
                  long equilibria) {
    const bool touches =
        !stage.machine.tool.empty() || !stage.machine.blade.empty() || stage.sim.self_contact;
    CostRange count = kEquilibria.times(stage.frames);
    if (!touches) count = {double(stage.frames), 1.5 * stage.frames};
    if (equilibria > 0) count = {double(equilibria), 1.1 * double(equilibria)};
    if (scene.breaks()) count.most *= touches ? kCracking : kCrackingAlong;
    const double iterations = most_iterations(scene, load);
    const double each = kRelaxed * load.particles + kRelaxedPoint * load.surface_points;
    if (!touches) {
        const bool changes = scene.yields() || scene.breaks();
        const CostRange smooth = (changes ? kYielding : kSmooth).times(load.particles);
        const double last = changes ? kRelaxed : kNewtonStep;
        StageTime time = {{count.least * smooth.least / (kNewtonStep * load.particles),
                           count.most * smooth.most / (last * load.particles)},
                          {count.least * smooth.least, count.most * smooth.most}};
        if (!stage.machine.load.empty() || stage.sim.gravity != Vec3::Zero()) {
            time.steps.most += count.most * iterations;
            time.seconds.most += count.most * iterations * each * kMachine.most;
        }
        return time;
    }
    CostRange each_takes = {kIterations.least, iterations};
    if (!stage.machine.blade.empty()) each_takes.least = kCutIterations.least;
    if (only_cuts(scene, stage)) each_takes.most = kCutIterations.most;
    const CostRange steps = {count.least * each_takes.least, count.most * each_takes.most};
    CostRange seconds = {steps.least * each * kMachine.least, steps.most * each * kMachine.most};
    if (!stage.machine.blade.empty()) {
        const CostRange cut = kCutEquilibrium.times(load.particles);
        seconds.add({count.least * cut.least, count.most * cut.most});
    }
    return {steps, seconds};
}

// Whole ones in each leg, and one for a frame of free flight.
double elastic_steps(const StageSpec& stage, const WorkLoad& load, double per_second) {
    constexpr double kRounding = 1e-9;
    const auto steps_in = [&](double time) {
        return std::max(1.0, std::ceil(time * per_second * (1 - kRounding)));
    };
    double all = stage.frames * steps_in(stage.duration / stage.frames);
    if (!load.leg.empty()) {
        all = 0;
        for (double time : load.leg) all += steps_in(time);
    }
    const double flown = load.flight / stage.duration;
    return flown * stage.frames + (1 - flown) * all;
}

StageTime moved(const SceneSpec& scene, const StageSpec& stage, const WorkLoad& load) {
    const Strikes by = strikes(scene, stage);
    const bool by_euler = stage.sim.solver == Solver::euler;
    const double elastic =
        elastic_steps(stage, load, load.steps_per_second * (by_euler ? euler_steps(scene) : 1));
    CostRange steps = {elastic, elastic * (stage.machine.blade.empty() ? 1 : kLighter)};
    if (scene.yields()) {
        const double driven = is_driven(stage) ? kFlattenedByMachines : 1;
        steps.most *= std::min(kFlattest, std::max(driven, 1 + kFlattened * by.flowing));
    }
    if (stage.sim.solver == Solver::energy_stepped) {
        const CostRange more = energy_steps(scene, stage);
        steps = {steps.least * more.least, steps.most * more.most};
    }
    double each =
        load.particles * (kCells + (scene.damps() ? kDashpots : 0) + (scene.yields() ? kFlow : 0));
    if (stage.sim.medium_density > 0 || stage.sim.directional_drag > 0) {
        each += load.surface_points * kDrag;
    }
    double meeting = 0;
    if (!stage.machine.tool.empty()) meeting += load.surface_points * kTools;
    if (scene.body.size() > 1 || stage.sim.self_contact) meeting += load.surface_points * kMeets;
    if (yields_as_springs(scene)) meeting += load.particles * kFlowOfSprings;
    if (scene.breaks()) {
        const double driven = is_driven(stage) ? kBreakingByMachines : 0;
        steps.most *= kTakenBack;
        meeting +=
            load.particles *
            std::min(kMostBreaking, std::max(driven, kBreaking.most * (1 + by.breaking.most)));
        each += load.particles * std::min(kMostBreaking, kBreaking.least * by.breaking.least);
    }
    return {steps,
            {steps.least * each * kMachine.least, steps.most * (each + meeting) * kMachine.most}};
}

}  // namespace

double CostRange::middle() const { return std::sqrt(least * most); }

double more_steps(const SceneSpec& scene, const StageSpec& stage) {
    const Solver solver = stage.sim.solver;
    if (solver == Solver::energy_stepped) return energy_steps(scene, stage).middle();
    return solver == Solver::euler ? euler_steps(scene) : 1;
}

StageTime stage_time(const SceneSpec& scene, const StageSpec& stage, const WorkLoad& load,
                     long equilibria) {
    if (!in_motion(stage.sim.solver)) return relaxed(scene, stage, load, equilibria);
    if (stage.sim.solver != Solver::implicit_steps) return moved(scene, stage, load);
    const double steps = kImplicitSteps * stage.frames;
    const double tools = stage.machine.tool.empty() ? 1 : kImplicitAtTools;
    return {{steps, tools * steps},
            {steps * load.particles * kImplicitStep.least,
             tools * steps * load.particles * kImplicitStep.most}};
}

CostRange writing_time(const SceneSpec& scene, double frames, const CostRange& bytes,
                       double particles) {
    bool parts = scene.breaks();
    for (const StageSpec& stage : scene.stage) parts = parts || !stage.machine.blade.empty();
    CostRange seconds = {0.5 * kSecondsPerByte * bytes.least, kSecondsPerByte * bytes.most};
    if (parts || scene.skin.kind == SkinKind::boundary) {
        seconds.add(kSkins.times(frames * particles));
    }
    return seconds;
}

double drawing_time(const RenderSettings& render, double stills) {
    const double pixels = static_cast<double>(render.width) * render.height;
    double each = kSecondsPerPixel + (render.passes.empty() ? 0 : kSecondsPerLayers);
    for (const PicturePass pass : render.passes) each += kSecondsPerPass[std::size_t(pass)];
    return stills * (kSecondsPerStill + pixels * each);
}

}  // namespace swage
