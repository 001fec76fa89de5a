// SPDX-License-Identifier: GPL-3.0-or-later
// What the guard of bodies in motion sees, takes back, and says.
#include <limits>
#include <utility>

#include "base/error.h"
#include "sim/advance.h"
#include "sim/cell_volume.h"
#include "sim/motion_guard.h"
#include "sim/moving_body.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Aggregate block(const Material& material = kSpringy) { return make_block(4, 3, 3, 0.1, material); }

}  // namespace

TEST_CASE("a particle without a place stops the run, and is named") {
    Aggregate m = block();
    m.particle_velocity.x[7] = kNan;
    const Apparatus nothing;
    Simulation simulation(m, nothing, motion_settings());
    try {
        simulation.advance(still(0), still(0.01));
        FAIL("it went on");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::stopped);
        const std::string text = error.what();
        INFO(text);
        CHECK(text.find("particle 7 of body 1 is lost") != std::string::npos);
        CHECK(text.find("connection of particles") != std::string::npos);
        CHECK(text.find("step_safety") != std::string::npos);
    }
}

TEST_CASE("a particle that would go far in a step makes the steps short, and none does") {
    Aggregate m = block();
    Apparatus pushes_by_nothing;  // and so keeps it from flying at once
    pushes_by_nothing.load.push_back(push_below(m, 0));
    const double dt = explicit_step(m, motion_settings());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(10 * 0.1 / dt, 0, 0));  // ten spacings a stable step
    }
    Simulation simulation(m, pushes_by_nothing, motion_settings());
    Drive begin = still(0), end = still(10 * dt);
    begin.load_strength = end.load_strength = {1};
    const FrameReport r = simulation.advance(begin, end);
    CHECK(r.shortest_step < 0.031 * dt);
    CHECK(r.rejected == 0);
    CHECK(r.steps >= 333);
    CHECK(m.particle_position.x[0] - m.particle_reference.at(0).x() == Approx(10.0).epsilon(1e-9));
}

TEST_CASE("a step that goes too far, or is lost, or turns a cell inside out, is found") {
    Aggregate m = block();
    const Apparatus nothing;
    const SimSettings settings = motion_settings();
    MovingBody body(m, 0, nothing, settings);
    CHECK_FALSE(look_at(body, 0.49 * 0.1, 0));
    CHECK(look_at(body, 0.51 * 0.1, 0).fault == Fault::too_far);
    CHECK(look_at(body, kNan, 0).fault == Fault::unsolved);
    double& one = m.particle_position.x[3];
    const double was = std::exchange(one, kNan);
    CHECK(look_at(body, kNan, 0).fault == Fault::lost);
    one = was;
    for (double& x : m.particle_position.x) x = -x;
    BodyOutcome outcome(nothing, 0);
    body.find_forces(still(0), 0, outcome);
    CHECK(body.inside_out() == 36);
    CHECK(look_at(body, 0, 35).fault == Fault::inside_out);
    CHECK_FALSE(look_at(body, 0, 36));
    const Finding finding = look_at(body, 0, 0);
    const auto text = [&](Solver solver) {
        return sentence_of(finding, body, "drop", 1e-6, solver);
    };
    CHECK(text(Solver::explicit_steps).find("cell 0 turns inside out") != std::string::npos);
    CHECK(text(Solver::explicit_steps).find("step_safety") != std::string::npos);
    // Which is no key of this solver.
    CHECK(text(Solver::energy_stepped).find("step_safety") == std::string::npos);
    CHECK(text(Solver::energy_stepped).find("solver = \"explicit\"") != std::string::npos);
}

TEST_CASE("rubber that is inside out is counted") {
    Material rubber = kSpringy;
    rubber.elasticity = Elasticity::neo_hookean;
    Aggregate m = block(rubber);
    for (double& x : m.particle_position.x) x = -x;
    const Apparatus nothing;
    const SimSettings settings = motion_settings();
    MovingBody body(m, 0, nothing, settings);
    BodyOutcome outcome(nothing, 0);
    body.find_forces(still(0), 0, outcome);
    CHECK(body.inside_out() == 36);
}

TEST_CASE("what flowed or cracked in steps that are taken back is forgotten") {
    for (Mechanics mechanics : {Mechanics::springs, Mechanics::cells}) {
        Material weak = kSpringy;
        weak.mechanics = mechanics;
        weak.yield_stress = 0.004 * weak.young_modulus, weak.hardening = weak.young_modulus;
        weak.strength = 0.03 * weak.young_modulus, weak.toughness = 0.01 * weak.strength;
        Aggregate m = block(weak);
        const Apparatus nothing;
        const SimSettings settings = motion_settings();
        MovingBody body(m, 0, nothing, settings);
        BodyOutcome outcome(nothing, 1);
        const auto pull_to = [&](double stretch) {
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const Vec3 x = m.particle_reference.at(p);
                m.particle_position.set(p, {stretch * x.x(), x.y(), x.z()});
            }
            body.find_forces(still(0), 0, outcome);
            body.finish_step(still(0), still(0), 0, outcome);
        };
        body.start(still(0), outcome);
        pull_to(1.01);
        body.find_forces(still(0), 0, outcome);
        const Vec3Array pulled = body.force();
        const std::uint64_t before = state_hash(m);
        MovingBody::State state;
        body.save(state);
        const double plastic = outcome.plastic_work;
        CHECK(plastic > 0);
        pull_to(1.2);
        CHECK(outcome.plastic_work > 2 * plastic);
        CHECK_FALSE(m.cell_cracked.empty());
        body.restore(state, outcome);
        CHECK(state_hash(m) == before);
        body.find_forces(still(0), 0, outcome);
        CHECK(body.force().x == pulled.x);
    }
}

TEST_CASE("branches of the damping give way where steps are taken back, and the books say so") {
    for (const Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        Material lossy = kSpringy;
        lossy.damping_ratio = 0.2;
        Aggregate m = block(lossy);
        const Apparatus nothing;
        SimSettings settings = motion_settings();
        settings.solver = solver;
        MovingBody body(m, 0, nothing, settings);
        BodyOutcome outcome(nothing, 1);
        const auto pull_to = [&](double stretch) {
            const double step = 0.1 * body.stable_step();
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const Vec3 x = stretch * m.particle_reference.at(p);
                m.particle_velocity.set(p, (x - m.particle_position.at(p)) / step);
                m.particle_position.set(p, x);
            }
            body.find_forces(still(0), step, outcome);
        };
        body.start(still(0), outcome);
        pull_to(1.01);
        const Vec3Array pulled = body.force();
        const double held = body.elastic_energy();
        MovingBody::State state;
        body.save(state);
        const BodyOutcome so_far = outcome;
        body.begin_block(outcome);
        pull_to(1.02);
        outcome = so_far;
        body.restore(state, outcome);
        body.find_forces(still(0), 0, outcome);
        const double left = body.elastic_energy(), lost = outcome.damped_work - so_far.damped_work;
        CHECK(left + lost == Approx(held).epsilon(1e-6));
        if (solver == Solver::energy_stepped) {
            CHECK(lost == 0);
            CHECK(farthest_move(pulled, body.force()) < 1e-6 * std::abs(pulled.x[0]));
        } else {
            CHECK(lost > 0.1 * held);
        }
    }
}

TEST_CASE("energy that appears from nowhere is refused once it is a twentieth of what was put in") {
    EnergyGuard guard;
    guard.start(100);
    CHECK(guard.accepts(0, 0, 0, 0.1));  // too little to be an alarm
    CHECK(guard.accepts(0, 0, 0, 4.8));  // within the tolerance
    CHECK_FALSE(guard.accepts(0, 0, 0, 0.3));
    CHECK(guard.accepts(0, 0, 0.05, 0.05));  // again too little
    CHECK(guard.accepts(50, 50, 0, 50));     // work was done
    CHECK_FALSE(guard.accepts(0, 0, 0, kNan));
    CHECK(guard.accepts(0, 0, 0, -90));  // losses are no alarm, and are not saved up for long
    CHECK_FALSE(guard.accepts(0, 0, 0, 20));
    CHECK_FALSE(guard.accepts(0, 0, 0, 2, 0, 0.01));  // much at once
    CHECK(guard.accepts(0, 0, 0, 2));
}

TEST_CASE("energy that creeps in by little in each block is stopped at a fifth") {
    EnergyGuard guard;
    guard.start(100);
    double held = 100;
    while (held < 1000 && guard.accepts(0, 0, 0, 0.19)) held += 0.19;
    CHECK(held == Approx(120).margin(0.2));
    CHECK(guard.accepts(0, 0, 0, 0));
    CHECK_FALSE(guard.accepts(0, 0, 0, kNan));
}

TEST_CASE("steps beyond the stable one are halved until energy keeps") {
    Aggregate m = block();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(p % 2 ? 0.1 : -0.1, p % 3 ? 0.1 : -0.1, 0));
    }
    const double start = kinetic_energy(m);
    SimSettings settings = motion_settings();
    settings.step_safety = 8;
    const Apparatus nothing;
    Simulation simulation(m, nothing, settings);
    const FrameReport r = simulation.advance(still(0), still(50 * explicit_step(m, settings)));
    CHECK(r.halvings > 0);
    CHECK(r.rejected > 0);
    CHECK(r.shortest_step < 0.2 * explicit_step(m, settings));
    CHECK(r.kinetic + r.elastic < 1.06 * start);
}

TEST_CASE("books count what the damping held where the first steps of a move are taken back") {
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    Aggregate m = block(material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(5 * m.particle_position.x[p], 0, 0));
    }
    const Apparatus nothing;
    SimSettings settings = motion_settings();
    const double step = explicit_step(m, settings);
    const FrameReport before = Simulation(m, nothing, settings).advance(still(0), still(20 * step));
    settings.step_safety = 8;
    Simulation simulation(m, nothing, settings);
    const FrameReport r = simulation.advance(still(20 * step), still(70 * step));
    REQUIRE(r.halvings > 0);
    CHECK(std::abs(r.remainder) < 0.01 * (before.kinetic + before.elastic));
}

TEST_CASE("a lattice crushed a hundred times comes back to its shape") {
    Material material = kSpringy;
    material.damping_ratio = 0.3;
    Aggregate m = block(material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, 0.01 * m.particle_reference.at(p));
    }
    const Apparatus nothing;
    Simulation simulation(m, nothing, motion_settings());
    const double period = 0.4 / std::sqrt(1e6 / 1000);
    for (int n = 0; n < 40; ++n) {
        simulation.advance(still(n * 4 * period), still((n + 1) * 4 * period));
    }
    CHECK(smallest_cell_volume(m) > 0.97);
    // Every connection is as long as it was; the body may have turned.
    CHECK(largest_stretch(m) < 0.03);
}

TEST_CASE("what rests stays with explicit steps, wherever it lies and whatever it is made of") {
    for (const Elasticity elasticity : {Elasticity::hencky, Elasticity::neo_hookean}) {
        Material m = kSpringy;
        m.elasticity = elasticity;
        for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.3, 0.1, 0), Vec3(40, -7, 3)}) {
            Aggregate a = make_block(4, 3, 3, 0.1, m);
            for (std::size_t p = 0; p < a.particle_count(); ++p) {
                a.particle_position.set(p, a.particle_position.at(p) + at);
            }
            const Apparatus nothing;
            Simulation simulation({&a}, nothing, motion_settings());
            for (int f = 0; f < 10; ++f) {
                const FrameReport r = simulation.advance(still(0.2 * f), still(0.2 * (f + 1)));
                CHECK(r.rejected == 0);
                CHECK(r.rescued == 0);
            }
        }
    }
}
