// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_solver.h"

#include <fmt/format.h>

#include <algorithm>

namespace swage {

namespace {

// What a solver cannot do with the scene's matter, and what to do instead.
void refuse(TableReader& table, const BodySpec& body, Solver solver) {
    const Material& material = body.material;
    bool is_damped = true, breaks = false;
    for (const Material* m : body.materials()) {
        is_damped = is_damped && m->damping_ratio > 0;
        breaks = breaks || m->breaks();
    }
    if (solver == Solver::euler && !is_damped) {
        table.mistake("solver",
                      fmt::format("solver = \"euler\" gains energy at any step size without "
                                  "damping: give {} a damping_ratio, or use solver = \"explicit\"",
                                  material.damping_ratio > 0 ? "each [[inset]]" : "[material]"));
    }
    if (solver != Solver::implicit_steps) return;
    if (material.mechanics == Mechanics::springs) {
        table.mistake("solver",
                      "solver = \"implicit\" needs mechanics = \"cells\" in [material], or use "
                      "solver = \"explicit\"");
    }
    if (breaks) {
        table.mistake(
            "solver",
            "solver = \"implicit\" does not follow cracks: leave out strength and toughness "
            "(strength = \"inf\" overrides a named material's), or use solver = \"explicit\"");
    }
}

// The stage whose blade has cut the matter of the next, or will; null: none.
const StageSpec* cut_in(const SceneSpec& scene) {
    for (auto stage = scene.stage.rbegin(); stage != scene.stage.rend(); ++stage) {
        if (!stage->machine.blade.empty()) return &*stage;
        if (stage->remold) break;
    }
    return nullptr;
}

void refuse_cut(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                bool remolds) {
    if (machine != nullptr && !machine->blade.empty()) {
        table.mistake("solver",
                      "solver = \"implicit\" does not follow cuts, and the machine has a blade: "
                      "use solver = \"explicit\"");
        return;
    }
    const StageSpec* cut = remolds ? nullptr : cut_in(scene);
    if (cut == nullptr) return;
    table.mistake("solver", fmt::format("solver = \"implicit\" cannot move cut matter, which stage "
                                        "\"{}\" leaves: use solver = \"explicit\" or remold = true",
                                        cut->name));
}

bool any_starts_moving(const SceneSpec& scene) {
    return std::any_of(scene.body.begin(), scene.body.end(),
                       [](const BodySpec& body) { return body.start.moves(); });
}

Solver chosen_solver(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                     Solver usual) {
    const bool machine_moves = machine != nullptr && machine->moves;
    const bool moves = scene.body.size() > 1 || any_starts_moving(scene) || machine_moves;
    Solver chosen = moves ? Solver::explicit_steps : usual;
    std::vector<std::pair<std::string, Solver>> solvers;
    for (const Solver solver : {Solver::quasistatic, Solver::explicit_steps, Solver::euler,
                                Solver::energy_stepped, Solver::implicit_steps}) {
        solvers.emplace_back(name_of(solver), solver);
    }
    table.choice<Solver>("solver", solvers, chosen);
    return chosen;
}

// What a solver cannot do at all, or does not do as somebody may expect.
void judge(TableReader& table, const SceneSpec& scene, const MachineSpec* machine, bool remolds,
           Solver solver) {
    const bool several = scene.body.size() > 1;
    if (!in_motion(solver) && (several || any_starts_moving(scene))) {
        table.mistake("solver", fmt::format("solver = \"quasistatic\" computes equilibria and "
                                            "allows {}: leave it out, or use solver = \"explicit\"",
                                            several ? "only one body" : "no velocity and no spin"));
    }
    for (const BodySpec& body : scene.body) refuse(table, body, solver);
    if (solver == Solver::implicit_steps) {
        refuse_cut(table, scene, machine, remolds);
        if (several) {
            table.mistake("solver",
                          "solver = \"implicit\" moves only one body: use solver = \"explicit\"");
        }
        if (scene.work_piece().gives_damping) {
            table.warn(
                "solver",
                "damping_ratio has no effect with solver = \"implicit\", whose steps damp by "
                "themselves");
        }
    }
    if (solver == Solver::euler && machine != nullptr && !machine->grip.empty()) {
        table.warn(
            "solver",
            "solver = \"euler\" gains energy wherever nothing damps, as where matter swings in a "
            "grip: a low grip_stiffness of 1 may keep it stable, else use solver = \"explicit\"");
    }
}

// Whether a blade parts what moves here, or has parted it before.
bool is_cut(const SceneSpec& scene, const MachineSpec* machine) {
    return (machine != nullptr && !machine->blade.empty()) ||
           std::any_of(scene.stage.begin(), scene.stage.end(),
                       [](const StageSpec& stage) { return !stage.machine.blade.empty(); });
}

void read_settings(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                   SimSettings& sim) {
    const auto number = [&](const std::string& key, double low, double high, double& into) {
        table.quantity(key, Quantity::number, between(low, high), into);
    };
    number("tolerance", 1e-4, 0.1, sim.tolerance);
    table.whole("iteration_limit", 100, 1'000'000, sim.iteration_limit);
    table.whole("halving_limit", 0, 8, sim.halving_limit);
    number("contact_stiffness", is_explicit(sim.solver) ? 0.01 : 0.5, 100, sim.contact_stiffness);
    number("grip_stiffness", 1, 100, sim.grip_stiffness);
    table.quantity("step_safety", Quantity::number, {.low = 0, .high = 1, .low_open = true},
                   sim.step_safety);
    table.whole("retry_limit", 0, 20, sim.retry_limit);
    sim.self_contact = follows_all_motion(sim.solver) && is_cut(scene, machine);
    table.truth("self_contact", sim.self_contact);
    table.truth("sleep", sim.sleep);
    table.quantity("medium_density", Quantity::density, at_least(0), sim.medium_density);
    table.quantity("drag_coefficient", Quantity::number, at_least(0), sim.drag_coefficient);
    table.quantity("directional_drag", Quantity::drag, at_least(0), sim.directional_drag);
    table.choice<DragAlong>("directional_drag_along",
                            {{"motion", DragAlong::motion}, {"normal", DragAlong::normal}},
                            sim.directional_drag_along);
    if (sim.solver == Solver::implicit_steps) {
        sim.self_contact = false;
        sim.medium_density = sim.directional_drag = 0;
    }
}

void read_gravity(TableReader& table, WorldAxis up, Vec3& gravity) {
    const Node* given = table.find("gravity");
    if (up == WorldAxis::automatic) up = WorldAxis::y;
    const Vec3 above = direction_of(up);
    if (given != nullptr && given->kind != Node::Kind::array) {
        double down = 0;  // a single number points down
        table.quantity("gravity", Quantity::acceleration, {}, down);
        gravity = (-down * above).array() + 0.0;
    } else {
        table.vector("gravity", Quantity::acceleration, gravity);
    }
    if (gravity != Vec3::Zero() && !(gravity.dot(above) < 0)) {
        table.warn(
            "gravity",
            fmt::format("gravity does not point down: {} is up, and a single number points down",
                        name_of(up)));
    }
}

void warn_if_nothing_happens(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                             const Vec3& gravity) {
    const bool acts = machine == nullptr || !machine->stands() || !machine->load.empty() ||
                      any_starts_moving(scene) || gravity != Vec3::Zero() ||
                      table.find("load") != nullptr;
    // What the stages before have left may spring back, or swing, by itself.
    if (acts || !scene.stage.empty()) return;
    if (machine->moves) {
        table.warn("machine",
                   "nothing moves: there is no gravity (gravity = \"9.81 m/s2\") and no load, and "
                   "no body starts with a velocity or spin");
    } else if (!machine->blade.empty()) {
        table.warn(
            "machine",
            fmt::format("nothing happens: blade {} never moves (it has no motion), and there is no "
                        "gravity (gravity = \"9.81 m/s2\") or load ([[stage.load]])",
                        machine->blade.front().name));
    } else if (machine->tool.empty() || machine->upright) {
        table.warn("machine",
                   "nothing happens: there is no gravity (gravity = \"9.81 m/s2\") or load "
                   "([[stage.load]])");
    }
}

}  // namespace

void read_solver(TableReader& table, const SceneSpec& scene, const MachineSpec* machine,
                 WorldAxis up, bool remolds, SimSettings& sim) {
    sim.solver = chosen_solver(table, scene, machine, sim.solver);
    judge(table, scene, machine, remolds, sim.solver);
    read_settings(table, scene, machine, sim);
    read_gravity(table, up, sim.gravity);
    warn_if_nothing_happens(table, scene, machine, sim.gravity);
}

}  // namespace swage
