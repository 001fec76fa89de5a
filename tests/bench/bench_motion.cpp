// SPDX-License-Identifier: GPL-3.0-or-later
// Explicit steps of a large body: milliseconds a step of a million particles that fall onto a
// plane, by all threads (bar 40 ms on two cores), with what its parts take; and what laws cost that
// a scene does not use: bare forces and moves by hand against a whole Simulation, then with one law
// after the other switched on. Medians, all in one run.
// Arguments: numbers of particles of the large body and of the one for the laws.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/moving_body.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.01;

double median(std::vector<double> of) {
    std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
    return of[of.size() / 2];
}

double ms_of(const std::function<void()>& act) {
    const auto start = std::chrono::steady_clock::now();
    act();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

double median_ms(int rounds, const std::function<void()>& act) {
    std::vector<double> took;
    for (int n = 0; n < rounds; ++n) took.push_back(ms_of(act));
    return median(took);
}

Material material(Mechanics mechanics) {
    return {.mechanics = mechanics, .young_modulus = 1e6, .density = 1000, .damping_ratio = 0};
}

Aggregate cube(double particles, const Material& m) {
    const int across = static_cast<int>(std::round(std::cbrt(particles))) - 1;
    return test::make_block(across, across, across, kSpacing, m);
}

Apparatus floor_tool(double friction) {
    Apparatus floor;
    floor.name = "floor";
    floor.tool.push_back({"floor", BoxShape{Vec3(99, 2, 99), 0}, friction});
    return floor;
}
// `below` the body's lowest side.
Drive floor_drive(const Aggregate& m, double time, double below) {
    Drive drive;
    drive.time = time;
    const double low = -0.5 * kSpacing * m.lattice.cell_count.y();
    drive.world_from_tool.push_back({Quat::Identity(), {0, low - 1 - below, 0}});
    return drive;
}

// A body that has just touched the plane and goes on into it.
void large(double particles, Mechanics mechanics, const char* name) {
    Aggregate m = cube(particles, material(mechanics));
    for (double& v : m.particle_velocity.y) v = -1;
    SimSettings settings{.solver = Solver::explicit_steps, .gravity = {0, -9.81, 0}};
    const Apparatus floor = floor_tool(0.3);
    Simulation simulation(m, floor, settings);
    const double step = explicit_step(m, settings);
    constexpr int kSteps = 64;  // one block
    double time = 0;
    long steps = 0;
    const auto go_on = [&] {
        const double next = time + (kSteps - 0.5) * step;
        steps = simulation.advance(floor_drive(m, time, 0), floor_drive(m, next, 0)).steps;
        time = next;
    };
    go_on();
    const std::clock_t start = std::clock();
    const double each = median_ms(3, go_on) / double(steps);
    const double busy = 1e3 * double(std::clock() - start) / CLOCKS_PER_SEC / double(3 * steps);
    fmt::print(
        "{} particles, {}, {} threads: {:.1f} ms a step (bar 40), {:.1f} ms of processor time\n",
        m.particle_count(), name, thread_count(), each, busy);

    MovingBody body(m, 0, floor, settings);
    BodyOutcome outcome(floor, body.pushes().count());
    const Drive now = floor_drive(m, time, 0);
    body.limit_stiffness(step);
    body.start(now, outcome);
    LatticeForces forces(m);
    Vec3Array f;
    MovingBody::State state;
    const auto part = [&](const char* what, const std::function<void()>& act) {
        act();
        fmt::print("    {:<34}{:>8.2f} ms\n", what, median_ms(5, act));
    };
    part("forces inside", [&] { forces.find(m, Flow::trial, f); });
    part("all forces", [&] { body.find_forces(now, step, outcome); });
    part("speeds and places", [&] { body.move(0, 0); });
    part("step's start", [&] { body.begin_step(now); });
    part("step's end, work and friction", [&] { body.finish_step(now, now, step, outcome); });
    part("a block's energy, twice a block", [&] { body.stored(now, step); });
    part("a block's copy, once a block", [&] { body.save(state); });
    part("candidates anew", [&] { body.find_candidates(now); });
}

// A scene of so many steps, whose time is asked again and again.
struct Scene {
    std::string name;
    std::function<void()> steps;
    std::vector<double> took{};
};

// Shares of a law that is not used, and of one that is.
void laws(double particles, Mechanics mechanics, const char* name) {
    constexpr int kSteps = 64;
    struct Body {
        Aggregate matter;
        Apparatus apparatus;
        SimSettings settings{.solver = Solver::explicit_steps};
        std::unique_ptr<Simulation> simulation;
        double time = 0, length = 0;
        long done = 0;
    };
    Aggregate still = cube(particles, material(mechanics));
    still.particle_position.x[0] += 1e-3 * kSpacing;  // without strain it would fly in one step
    const double step = explicit_step(still, {.solver = Solver::explicit_steps});
    std::vector<std::unique_ptr<Body>> bodies;
    std::vector<Scene> scenes;

    // Forces and moves alone, by hand.
    Aggregate bare = still;
    LatticeForces forces(bare);
    Vec3Array f;
    forces.find(bare, Flow::trial, f);
    for (double& v : bare.particle_velocity.x) v = 0.1;
    scenes.push_back({"forces and moves by hand", [&] {
                          for (int n = 0; n < kSteps; ++n) {
                              Vec3Array &x = bare.particle_position, &v = bare.particle_velocity;
                              parallel_for((x.size() + 2047) / 2048, [&](std::size_t chunk) {
                                  const std::size_t end = std::min(x.size(), (chunk + 1) * 2048);
                                  for (std::size_t p = chunk * 2048; p < end; ++p) {
                                      v.add(p, step / bare.particle_mass[p] * f.at(p));
                                      x.add(p, step * v.at(p));
                                  }
                              });
                              forces.find(bare, Flow::trial, f);
                          }
                      }});
    const auto add = [&](const char* what, const std::function<void(Body&)>& with) {
        bodies.push_back(std::make_unique<Body>());
        Body& body = *bodies.back();
        body.matter = still;
        for (double& v : body.matter.particle_velocity.x) v = 0.1;
        with(body);
        body.length = explicit_step(body.matter, body.settings);
        body.simulation = std::make_unique<Simulation>(body.matter, body.apparatus, body.settings);
        scenes.push_back({what, [&body] {
                              const double next = body.time + (kSteps - 0.5) * body.length;
                              const bool floor = !body.apparatus.tool.empty();
                              const auto drive = [&](double time) {
                                  Drive d;
                                  if (floor) d = floor_drive(body.matter, time, 0);
                                  d.time = time;
                                  return d;
                              };
                              body.simulation->advance(drive(body.time), drive(next));
                              body.time = next;
                          }});
    };
    add("a Simulation, all laws off", [](Body&) {});
    add("the same once more", [](Body&) {});
    add("gravity", [](Body& b) { b.settings.gravity = {0, 0, -1e-6}; });
    add("drag", [](Body& b) { b.settings.medium_density = 1.2; });
    add("contact with a floor", [](Body& b) { b.apparatus = floor_tool(0); });
    add("contact and friction", [](Body& b) { b.apparatus = floor_tool(0.3); });
    add("self-contact", [](Body& b) { b.settings.self_contact = true; });
    add("damping", [](Body& b) { b.matter.material.damping_ratio = 0.05; });
    add("fracture", [](Body& b) {
        b.matter.material.strength = 1e4;
        b.matter.material.toughness = 1e3;
    });
    add("plasticity", [](Body& b) { b.matter.material.yield_stress = 1e4; });
    for (const Scene& scene : scenes) scene.steps();
    for (int round = 0; round < 7; ++round) {
        for (Scene& scene : scenes) scene.took.push_back(ms_of(scene.steps));
    }
    // Of the ratios within each round, which shares what else the machine does.
    fmt::print("{} particles, {}: of a Simulation with all laws off\n", still.particle_count(),
               name);
    for (const Scene& scene : scenes) {
        std::vector<double> ratio;
        for (std::size_t n = 0; n < scene.took.size(); ++n) {
            ratio.push_back(scene.took[n] / scenes[1].took[n]);
        }
        fmt::print("    {:<34}{:>8.2f} ms a step{:>9.3f}\n", scene.name,
                   median(scene.took) / kSteps, median(ratio));
    }
}

}  // namespace

int main(int argc, char** argv) {
    const double many = argc > 1 ? std::atof(argv[1]) : 1e6;
    const double some = argc > 2 ? std::atof(argv[2]) : 5e4;
    large(many, Mechanics::springs, "springs");
    large(many, Mechanics::cells, "cells");
    set_thread_count(1);
    laws(some, Mechanics::springs, "springs");
    laws(some, Mechanics::cells, "cells");
}
