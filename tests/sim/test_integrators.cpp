// SPDX-License-Identifier: GPL-3.0-or-later
// The integrators: their order, their energy, and what each is for.
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "sim/energy_steps.h"
#include "sim/implicit_step.h"
#include "sim/moving_body.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Apparatus kNothing;

// A bar along x that swings along its axis by small strains: displacement at the time t.
Aggregate after_swing(Solver solver, double time, int frames, double safety, double damping,
                      FrameReport* last = nullptr) {
    Material material = kSpringy;
    material.damping_ratio = damping;
    Aggregate m = make_block(8, 1, 1, 0.1, material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const double x = m.particle_reference.at(p).x();
        m.particle_velocity.set(p, Vec3(0.01 * std::sin(kPi * x / 0.8), 0, 0));
    }
    SimSettings settings = motion_settings(solver);
    settings.step_safety = safety;
    Simulation simulation(m, kNothing, settings);
    FrameReport r;
    for (int n = 0; n < frames; ++n) {
        r = simulation.advance(still(time * n / frames), still(time * (n + 1) / frames));
    }
    if (last != nullptr) *last = r;
    return m;
}

double difference(const Aggregate& a, const Aggregate& b) {
    double sum = 0;
    for (std::size_t p = 0; p < a.particle_count(); ++p) {
        sum += (a.particle_position.at(p) - b.particle_position.at(p)).squaredNorm();
    }
    return std::sqrt(sum);
}

constexpr double kTime = 0.02;  // two fifths of a period

// A floor whose upper side is y = 0.
Apparatus ground() {
    Apparatus a;
    a.name = "drop";
    a.tool.push_back({"floor", BoxShape{Vec3(50, 2, 50), 0}, 0.3});
    return a;
}
Drive on_ground(double time) {
    Drive d = still(time);
    d.world_from_tool.push_back({Quat::Identity(), Vec3(0, -1, 0)});
    return d;
}

double lowest(const Aggregate& m) {
    return *std::min_element(m.particle_position.y.begin(), m.particle_position.y.end());
}

}  // namespace

TEST_CASE("symplectic steps follow a swing with the second order of the step") {
    const Aggregate exact = after_swing(Solver::explicit_steps, kTime, 1, 0.01, 0);
    const double coarse = difference(after_swing(Solver::explicit_steps, kTime, 1, 0.8, 0), exact);
    const double fine = difference(after_swing(Solver::explicit_steps, kTime, 1, 0.4, 0), exact);
    CHECK(coarse / fine > 3);
    CHECK(coarse / fine < 6);
}

TEST_CASE("the papers' Euler follows a damped swing with the first order of the step") {
    const Aggregate exact = after_swing(Solver::euler, kTime, 1, 0.005, 0.2);
    const double coarse = difference(after_swing(Solver::euler, kTime, 1, 0.4, 0.2), exact);
    const double fine = difference(after_swing(Solver::euler, kTime, 1, 0.2, 0.2), exact);
    CHECK(coarse / fine > 1.6);
    CHECK(coarse / fine < 2.6);
    const Aggregate other = after_swing(Solver::explicit_steps, kTime, 1, 0.05, 0.2);
    CHECK(difference(exact, other) < 0.02 * difference(exact, make_block(8, 1, 1, 0.1, kSpringy)));
}

TEST_CASE("the papers' Euler gains no energy in what hardly changes its volume, or is of springs") {
    for (const auto& [ratio, mechanics] :
         {std::pair(0.0, Mechanics::cells), std::pair(0.3, Mechanics::cells),
          std::pair(0.49, Mechanics::cells), std::pair(0.25, Mechanics::springs)}) {
        Material material = kSpringy;
        material.poisson_ratio = ratio;
        material.mechanics = mechanics;
        material.damping_ratio = 0.1;
        Aggregate m = make_block(3, 3, 3, 0.1, material);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {  // a tremor of every swing there is
            const double way = 1e-3 * std::sin(1e3 * double(p * p));
            m.particle_velocity.set(p, Vec3(way, -way, way));
        }
        const SimSettings settings = motion_settings(Solver::euler);
        Simulation simulation(m, kNothing, settings);
        double held = std::numeric_limits<double>::infinity();
        for (int n = 0; n < 5; ++n) {
            const FrameReport r = simulation.advance(still(0.04 * n), still(0.04 * (n + 1)));
            INFO(ratio);
            CHECK(r.kinetic + r.elastic < held);
            held = r.kinetic + r.elastic;
        }
    }
}

TEST_CASE("the papers' Euler gains energy where nothing damps, and is stopped") {
    // Its step has no length then; the scene reader refuses it before.
    Aggregate m = make_block(4, 1, 1, 0.1, kSpringy);
    for (double& v : m.particle_velocity.x) v = 1;
    Simulation simulation(m, kNothing, motion_settings(Solver::euler));
    CHECK_THROWS_AS(simulation.advance(still(0), still(0.01)), Error);
}

TEST_CASE("implicit steps follow a swing with the first order of the step, and only lose energy") {
    const Aggregate exact = after_swing(Solver::explicit_steps, kTime, 1, 0.01, 0);
    FrameReport r;
    const double coarse =
        difference(after_swing(Solver::implicit_steps, kTime, 40, 0.8, 0, &r), exact);
    const double energy = r.kinetic + r.elastic;
    const double fine =
        difference(after_swing(Solver::implicit_steps, kTime, 80, 0.8, 0, &r), exact);
    CHECK(coarse / fine > 1.7);
    CHECK(coarse / fine < 2.4);
    CHECK(r.remainder > 0);  // what the steps took
    CHECK(r.kinetic + r.elastic > energy);
}

TEST_CASE("implicit steps a thousand times the stable one bring a held bar to rest as it hangs") {
    Aggregate m = make_block(10, 2, 2, 0.05, kSpringy);
    Apparatus clamp;
    clamp.name = "clamp";
    Grip g;
    g.name = "hold";
    g.point = points_where(m, [](const Vec3& x) { return x.x() < -0.25 + 1e-9; });
    for (int p : g.point) g.anchor.push_back(m.surface_position(p));
    clamp.grip.push_back(g);
    const auto drive = [](double t) {
        Drive d = still(t);
        d.world_from_grip.push_back({Quat::Identity(), Vec3::Zero()});
        return d;
    };
    SimSettings settings = motion_settings(Solver::implicit_steps);
    settings.gravity = {0, -1, 0};
    const double frame = 4 * 1000 * explicit_step(m, settings);
    Simulation simulation(m, clamp, settings);
    FrameReport r;
    for (int n = 0; n < 6; ++n) r = simulation.advance(drive(frame * n), drive(frame * (n + 1)));
    CHECK(r.steps == 4);
    CHECK(r.rejected == 0);
    Aggregate rest = make_block(10, 2, 2, 0.05, kSpringy);
    SimSettings quiet = settings;
    quiet.solver = Solver::quasistatic;
    quiet.tolerance = 1e-4;
    Simulation relaxed(rest, clamp, quiet);
    relaxed.advance(drive(0), drive(1));
    double sag = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        sag = std::max(sag, rest.particle_reference.at(p).y() - rest.particle_position.y[p]);
    }
    CHECK(sag > 0.001);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        CHECK((m.particle_position.at(p) - rest.particle_position.at(p)).norm() < 0.01 * sag);
    }
}

TEST_CASE("a body that falls by implicit steps lands on the floor and stays on it") {
    Aggregate m = make_block(3, 3, 3, 0.1, kSpringy);
    for (double& y : m.particle_position.y) y += 0.25;
    SimSettings settings = motion_settings(Solver::implicit_steps);
    settings.gravity = {0, -9.81, 0};
    const Apparatus apparatus = ground();
    Simulation simulation(m, apparatus, settings);
    double deepest = 0;
    FrameReport r;
    for (int n = 0; n < 60; ++n) {
        r = simulation.advance(on_ground(0.02 * n), on_ground(0.02 * (n + 1)));
        deepest = std::min(deepest, lowest(m));
    }
    CHECK(deepest > -0.03);
    CHECK(lowest(m) > -0.01);
    CHECK(lowest(m) < 0.001);
    CHECK(r.kinetic < 1e-3 * m.mass() * 9.81 * 0.1);
    CHECK(r.load[0].force.y() == Approx(m.mass() * 9.81).epsilon(0.01));
}

TEST_CASE("implicit steps refuse what they cannot move") {
    Material springs = kSpringy;
    springs.mechanics = Mechanics::springs;
    Aggregate m = make_block(2, 1, 1, 0.1, springs);
    CHECK(ImplicitStep::cannot(m) != nullptr);
    CHECK(ImplicitStep::cannot(make_block(2, 1, 1, 0.1, kSpringy)) == nullptr);
    CHECK_THROWS_AS(Simulation(m, kNothing, motion_settings(Solver::implicit_steps)), Error);
    Aggregate cut = make_block(3, 3, 1, 0.1, kSpringy);
    break_layer(cut, 1);
    REQUIRE(ImplicitStep::cannot(cut) != nullptr);
    CHECK(std::string(ImplicitStep::cannot(cut)) == "matter that is cut has no exact tangent");
}

TEST_CASE("solvers that move one body refuse several") {
    Aggregate one = make_block(1, 1, 1, 0.1, kSpringy), other = one;
    for (double& x : other.particle_position.x) x += 1;
    for (const Solver solver : {Solver::quasistatic, Solver::implicit_steps}) {
        CHECK_THROWS_AS(Simulation({&one, &other}, kNothing, motion_settings(solver)), Error);
    }
}

TEST_CASE("steps that energy chooses never gain any, lose none either, and few are taken back") {
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    Aggregate m = make_block(3, 2, 2, 0.1, material);
    for (double& y : m.particle_position.y) y += 0.3;
    SimSettings settings = motion_settings(Solver::energy_stepped);
    settings.gravity = {0, -9.81, 0};
    const Apparatus apparatus = ground();
    Simulation simulation(m, apparatus, settings);
    long steps = 0, rejected = 0;
    const double energy = m.mass() * 9.81 * 0.2;
    double before = 1e300, damped = 0;
    for (int n = 0; n < 12; ++n) {
        const FrameReport r = simulation.advance(on_ground(0.025 * n), on_ground(0.025 * (n + 1)));
        steps += r.steps, rejected += r.rejected;
        CHECK(r.kinetic + r.elastic + r.contact - r.gravity_work < before + 1e-6 * energy);
        before = r.kinetic + r.elastic + r.contact - r.gravity_work;
        CHECK(std::abs(r.remainder) < 1e-3 * energy);
        damped = r.damped;
    }
    CHECK(steps > 20);
    CHECK(damped > 0.1 * energy);
    CHECK(double(steps + rejected) / double(steps) < 1.5);
    CHECK(lowest(m) > -0.05);
    CHECK(lowest(m) < 0.25);
}

TEST_CASE("bodies far apart take their own steps, those that may meet the same") {
    Material stiff = kSpringy;
    stiff.young_modulus = 1e10;
    const auto steps = [&](double apart) {
        Aggregate soft = make_block(2, 1, 1, 0.1, kSpringy);
        Aggregate hard = make_block(2, 1, 1, 0.1, stiff);
        for (double& x : hard.particle_position.x) x += apart;
        for (Aggregate* m : {&soft, &hard}) {
            for (std::size_t p = 0; p < m->particle_count(); ++p) {
                m->particle_velocity.x[p] = 0.001 * (p % 2 ? 1 : -1);
            }
        }
        Simulation simulation({&soft, &hard}, kNothing, motion_settings(Solver::energy_stepped));
        return simulation.advance(still(0), still(2e-4)).steps;
    };
    // The soft one's few steps are in the count when it goes alone.
    CHECK(steps(10) != steps(0.35));
}

TEST_CASE(
    "what gravity gives two bodies in contact is booked as it grows, whatever stands before") {
    const Aggregate block = make_block(2, 2, 2, 0.01, kSpringy);
    const auto passed = [&](bool behind) {
        std::vector<Aggregate> body(3, block);
        place(body[0], {Quat::Identity(), Vec3(0, 1, 0)});
        place(body[2], {Quat::Identity(), Vec3(0.0201, 0, 0)});
        for (double& v : body[1].particle_velocity.x) v = 1;
        std::vector<Aggregate*> bodies = {&body[1], &body[2]};
        bodies.insert(behind ? bodies.end() : bodies.begin(), &body[0]);
        SimSettings settings = motion_settings(Solver::energy_stepped);
        settings.gravity = {100, 0, 0};
        Simulation simulation(bodies, kNothing, settings);
        Drive from = still(0), to = still(0.001);
        from.gravity_strength = 0;
        return simulation.advance(from, to).body[behind ? 0 : 1].passed;
    };
    const double alone = passed(true);
    REQUIRE(alone != 0);
    CHECK(passed(false) == Approx(alone).epsilon(1e-9));
}

TEST_CASE("steps that energy chooses follow what a drive does within a frame, also after a pause",
          "[stress]") {
    Aggregate start = make_block(3, 3, 3, 0.01, kSpringy);
    Apparatus pull;
    for (int side : {-1, 1}) {
        Grip& grip = pull.grip.emplace_back();
        grip.point = points_where(start, [&](const Vec3& x) { return side * x.x() > 0.0149; });
        for (int p : grip.point) grip.anchor.push_back(start.surface_reference(p));
    }
    Apparatus push;
    push.load.push_back(push_below(start, 4));
    const double pause = GENERATE(0.0, 0.01);
    const auto drive = [&](double time) {
        const double s = std::max(0.0, time - pause) / 0.01;
        Drive d = still(time);
        d.world_from_grip.assign(2, {Quat::Identity(), Vec3::Zero()});
        d.world_from_grip[1].translation.x() = 0.003 * s;
        d.load_strength = {s};
        return d;
    };
    const auto moved = [&](const Apparatus& apparatus, Solver solver, int frames) {
        Aggregate m = start;
        SimSettings settings = motion_settings(solver);
        settings.step_safety = 0.1;
        Simulation simulation(m, apparatus, settings);
        FrameReport r;
        const double end = pause + 0.01;
        for (int n = 0; n < frames; ++n) {
            r = simulation.advance(drive(end / frames * n), drive(end / frames * (n + 1)));
        }
        return std::pair{m, r};
    };
    const auto [far, put_in] = moved(push, Solver::explicit_steps, 2);
    const int few = pause > 0 ? 2 : 1;
    for (const int frames : {few, 40}) {
        const auto [pushed, r] = moved(push, Solver::energy_stepped, frames);
        CHECK(r.load_work == Approx(put_in.load_work).epsilon(0.01));
        CHECK(pushed.mean_velocity().x() == Approx(far.mean_velocity().x()).epsilon(0.01));
    }
    const FrameReport coarse = moved(pull, Solver::energy_stepped, few).second,
                      fine = moved(pull, Solver::energy_stepped, 40).second;
    CHECK(coarse.work == Approx(fine.work).epsilon(0.02));
    CHECK(coarse.elastic == Approx(fine.elastic).epsilon(0.02));
    CHECK(coarse.kinetic < 0.2 * coarse.elastic);
}

TEST_CASE("steps that energy chooses see what a tool or a load sends into another body") {
    Material smooth = kSpringy;
    smooth.young_modulus = 1e5;
    smooth.friction = 0;
    const Aggregate block = make_block(2, 2, 2, 0.01, smooth);
    const auto passed = [&](int frames, bool by_tool) {
        std::vector<Aggregate> body(3, block);
        place(body[1], {Quat::Identity(), Vec3(0.04, 0.002, 0.001)});
        place(body[2], {Quat::Identity(), Vec3(0.08, 0.001, 0.002)});
        Apparatus apparatus;
        if (by_tool) {
            apparatus.tool.push_back({"ram", BoxShape{Vec3(0.02, 0.06, 0.06), 0}, 0});
        } else {
            apparatus.load.push_back(push_below(block, 5));
        }
        const auto drive = [&](double time) {
            Drive d = still(time);
            if (by_tool) d.world_from_tool = {{Quat::Identity(), Vec3(time - 0.03, 0, 0)}};
            if (!by_tool) d.load_strength = {time / 0.05};
            return d;
        };
        Simulation simulation({&body[0], &body[1], &body[2]}, apparatus,
                              motion_settings(Solver::energy_stepped));
        const double frame = (by_tool ? 0.045 : 0.055) / frames;
        for (int n = 0; n < frames; ++n)
            simulation.advance(drive(frame * n), drive(frame * (n + 1)));
        return body[1].mean_velocity().x() + body[2].mean_velocity().x();
    };
    for (const bool by_tool : {true, false}) {
        const double one = passed(1, by_tool), many = passed(20, by_tool);
        CHECK(many > 0.5);
        CHECK(one == Approx(many).epsilon(0.03));
    }
}

TEST_CASE("every integrator gives the same bytes with one thread and two") {
    for (const Solver solver :
         {Solver::explicit_steps, Solver::euler, Solver::energy_stepped, Solver::implicit_steps}) {
        std::uint64_t hash[2];
        for (const int threads : {1, 2}) {
            set_thread_count(threads);
            Material material = kSpringy;
            material.damping_ratio = 0.1;
            Aggregate m = make_block(6, 5, 5, 0.1, material);
            for (double& y : m.particle_position.y) y += 0.251;
            for (double& v : m.particle_velocity.y) v = -1;
            SimSettings settings = motion_settings(solver);
            settings.gravity = {0, -9.81, 0};
            const Apparatus apparatus = ground();
            Simulation simulation(m, apparatus, settings);
            simulation.advance(on_ground(0), on_ground(0.01));
            hash[threads - 1] = state_hash(m);
        }
        set_thread_count(0);
        INFO("solver " << static_cast<int>(solver));
        CHECK(hash[0] == hash[1]);
    }
}

TEST_CASE("bodies large enough to be shared out give the same bytes with one thread, two and three",
          "[stress]") {
    for (const Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        std::uint64_t hash[3][2];
        for (const int threads : {1, 2, 3}) {
            set_thread_count(threads);
            Material material = kSpringy;
            material.damping_ratio = 0.1;
            material.yield_stress = 2e3;
            material.friction = 0.3;
            // Large enough for several slabs and chunks each, in bodies moved on at once.
            Aggregate low = make_block(22, 20, 22, 0.01, material), high = low;
            for (double& y : low.particle_position.y) y += 0.0999;
            for (double& y : high.particle_position.y) y += 0.2998;
            for (double& v : high.particle_velocity.y) v = -1;
            SimSettings settings = motion_settings(solver);
            settings.gravity = {0, -9.81, 0};
            const Apparatus apparatus = ground();
            Simulation simulation({&low, &high}, apparatus, settings);
            const FrameReport r = simulation.advance(on_ground(0), on_ground(0.0005));
            CHECK(r.plastic > 0);
            CHECK(r.damped > 0);
            CHECK(r.friction > 0);
            hash[threads - 1][0] = state_hash(low);
            hash[threads - 1][1] = state_hash(high);
        }
        set_thread_count(0);
        INFO("solver " << static_cast<int>(solver));
        for (int other : {1, 2}) {
            CHECK(hash[other][0] == hash[0][0]);
            CHECK(hash[other][1] == hash[0][1]);
        }
    }
}

TEST_CASE("many bodies that break as they fall leave the same bytes with any number of threads",
          "[stress]") {
    std::vector<std::vector<std::uint64_t>> hash;
    for (const int threads : {1, 2, 8}) {
        set_thread_count(threads);
        Material material = kSpringy;
        material.damping_ratio = 0.1;
        material.friction = 0.3;
        material.strength = 2e3;
        material.toughness = 0.2;
        std::vector<Aggregate> body;
        for (int n = 0; n < 8; ++n) {
            body.push_back(make_block(5, 5, 5 + n % 3, 0.01, material));
            for (std::size_t p = 0; p < body[n].particle_count(); ++p) {
                body[n].particle_position.add(
                    p, Vec3(0.052 * (n % 4), 0.0251 + 0.051 * (n / 4), 0.003 * n));
                body[n].particle_velocity.set(p, Vec3(0, -2 - n % 3, 0));
            }
        }
        std::vector<Aggregate*> bodies;
        for (Aggregate& one : body) bodies.push_back(&one);
        SimSettings settings = motion_settings(Solver::explicit_steps);
        settings.gravity = {0, -9.81, 0};
        const Apparatus apparatus = ground();
        Simulation simulation(bodies, apparatus, settings);
        const FrameReport r = simulation.advance(on_ground(0), on_ground(0.002));
        CHECK(r.broken > 0);
        CHECK(r.friction > 0);
        hash.emplace_back();
        for (const Aggregate& one : body) hash.back().push_back(state_hash(one));
    }
    set_thread_count(0);
    CHECK(hash[1] == hash[0]);
    CHECK(hash[2] == hash[0]);
}
