// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that lose speed in explicit steps: to their own matter, and to what is around them.
#include <array>
#include <functional>

#include "sim/advance.h"
#include "sim/moving_body.h"
#include "sim/surface_drag.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"
#include "tests/sim/steady_flow.h"

using namespace swage;
using namespace swage::test;

namespace {

Material springy(double damping_ratio) {
    return {.young_modulus = 1e6,
            .poisson_ratio = 0.25,
            .density = 1000,
            .damping_ratio = damping_ratio};
}

Vec3 mean_velocity(const Aggregate& m) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        sum += m.particle_mass[p] * m.particle_velocity.at(p);
    }
    return sum / m.mass();
}

// Free vibration from a first mode's velocities: the ratio that its energy's decay tells, over
// `periods` of a sine whose zeros are those of `swing`.
double decay_ratio(Aggregate& m, const std::function<double(const Aggregate&)>& swing,
                   double about_period, int periods) {
    const Apparatus nothing;
    SimSettings settings = motion_settings();
    settings.step_safety = 0.3;
    Simulation simulation(m, nothing, settings);
    const double dt = about_period / 40;
    double time = 0, last = swing(m), first_zero = 0, zero = 0, first_energy = 0, energy = 0;
    int zeros = 0;
    while (zeros < 2 * periods + 1) {
        const FrameReport r = simulation.advance(still(time), still(time + dt));
        const double now = swing(m);
        if (time > 0 && (now > 0) != (last > 0)) {
            zero = time + dt * last / (last - now);
            energy = r.kinetic + r.elastic;
            if (zeros++ == 0) first_zero = zero, first_energy = energy;
        }
        last = now;
        time += dt;
        REQUIRE(time < 4 * about_period * (periods + 2));
    }
    const double frequency = 2 * kPi * periods / (zero - first_zero);
    return std::log(first_energy / energy) / (2 * frequency * (zero - first_zero));
}

}  // namespace

TEST_CASE("a free bar's first modes decay by the damping ratio, in stretch and in bending") {
    for (const double ratio : {0.02, 0.1}) {
        Aggregate bar = make_block(24, 4, 4, 0.025, springy(ratio));
        const double length = 0.6, speed = std::sqrt(1e3);
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            bar.particle_velocity.set(
                p, {0.01 * std::sin(kPi * bar.particle_reference.at(p).x() / length), 0, 0});
        }
        const auto end = [](const Aggregate& m, int axis) {
            double sum = 0;
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const double x = m.particle_reference.at(p).x();
                if (std::abs(x) < 0.29) continue;
                const double way =
                    m.particle_position.at(p)[axis] - m.particle_reference.at(p)[axis];
                sum += axis == 0 ? std::copysign(way, way * x) : way;
            }
            return sum;
        };
        CHECK(decay_ratio(
                  bar, [&](const Aggregate& m) { return end(m, 0); }, 2 * length / speed, 2) ==
              Approx(ratio).epsilon(0.15));

        // The first bending mode of a free beam, beta L = 4.73004.
        bar = make_block(24, 4, 4, 0.025, springy(ratio));
        const double beta = 4.730041 / length, sigma = 0.982502;
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            const double s = beta * (bar.particle_reference.at(p).x() + 0.5 * length);
            bar.particle_velocity.set(
                p,
                {0, 0, 0.01 * (std::cosh(s) + std::cos(s) - sigma * (std::sinh(s) + std::sin(s)))});
        }
        const double frequency = beta * beta * speed * 0.1 / std::sqrt(12.0);
        CHECK(decay_ratio(
                  bar, [&](const Aggregate& m) { return end(m, 2); }, 2 * kPi / frequency, 2) ==
              Approx(ratio).epsilon(0.2));
    }
}

TEST_CASE("internal damping neither slows nor turns a body that flies and spins") {
    Aggregate m = make_block(5, 3, 2, 0.1, springy(0.1));
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(
            p, Vec3(3, -1, 2) + Vec3(0.1, 0.2, -0.3).cross(m.particle_reference.at(p)));
    }
    const auto momenta = [&] {
        Vec3 turn = Vec3::Zero();
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            turn += m.particle_mass[p] * m.particle_position.at(p).cross(m.particle_velocity.at(p));
        }
        return std::pair(Vec3(m.mass() * mean_velocity(m)), turn);
    };
    const auto before = momenta();
    const Apparatus nothing;
    Simulation simulation(m, nothing, motion_settings());
    simulation.advance(still(0), still(0.3));
    const auto after = momenta();
    CHECK((after.first - before.first).norm() < 1e-11 * before.first.norm());
    CHECK((after.second - before.second).norm() < 1e-10 * before.first.norm());
}

TEST_CASE("a damped body that spins keeps its energy, and what its spin strains it by") {
    const double length = 0.6, spin = 15, density = 1000, modulus = 1e6;
    Aggregate m = make_block(24, 2, 2, 0.025, springy(0.1));
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(0, 0, spin).cross(m.particle_reference.at(p)));
    }
    const Apparatus nothing;
    Simulation simulation(m, nothing, motion_settings());
    double most = 0;
    FrameReport r, early;
    for (int n = 1; n <= 20; ++n) {
        r = simulation.advance(still(0.1 * (n - 1)), still(0.1 * n));
        most = std::max(most, std::abs(r.remainder));
        if (n == 10) early = r;
    }
    CHECK(most < 1e-4 * r.kinetic);
    // Once its first swings have died away nothing is lost.
    CHECK(std::abs(r.damped - early.damped) < 2e-4 * r.kinetic);
    const double held = std::pow(0.05, 2) * std::pow(density, 2) * std::pow(spin, 4) *
                        std::pow(length, 5) / (240 * modulus);
    CHECK(r.elastic == Approx(held).epsilon(0.05));
}

TEST_CASE("what damping remembers goes from one stage on into the next") {
    for (const Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        const auto stretched = [&] {
            Aggregate m = make_block(6, 2, 2, 0.1, springy(0.05));
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                m.particle_velocity.set(p, {0.5 * m.particle_reference.at(p).x(), 0, 0});
            }
            return m;
        };
        const Apparatus nothing;
        SimSettings settings = motion_settings();
        settings.solver = solver;
        Aggregate one = stretched(), two = stretched();
        Simulation whole(one, nothing, settings), first(two, nothing, settings);
        whole.advance(still(0), still(0.02));
        const double held = first.advance(still(0), still(0.02)).elastic;
        Simulation second(two, nothing, settings);
        CHECK(second.start().elastic == Approx(held).epsilon(1e-9));
        const FrameReport unbroken = whole.advance(still(0.02), still(0.04));
        const FrameReport after = second.advance(still(0.02), still(0.04));
        CHECK(std::abs(after.remainder) < 1e-3 * held);
        CHECK(after.elastic == Approx(unbroken.elastic).epsilon(1e-3));
        // Steps that the energy chooses begin anew.
        if (solver == Solver::explicit_steps) CHECK(state_hash(one) == state_hash(two));
        // At rest nothing is left of it.
        settings.solver = Solver::quasistatic;
        Simulation at_rest(two, nothing, settings);
        CHECK(two.branch_memory.empty());
    }
}

TEST_CASE("a body falling through air follows the tanh of quadratic drag") {
    // Terminal speed 10 m/s: m g = 1/2 c rho (A / 4) v^2.
    Aggregate m = make_block(3, 3, 3, 0.1, springy(0.1));
    double area = 0;
    for (std::size_t p = 0; p < m.surface.size(); ++p) area += m.surface.area(p);
    SimSettings settings = motion_settings();
    settings.gravity = {0, -9.81, 0};
    settings.step_safety = 0.2;
    settings.drag_coefficient = 0.8;
    settings.medium_density = m.mass() * 9.81 / (0.5 * 0.8 * 0.25 * area * 100);
    const Apparatus nothing;
    const double start = m.particle_position.at(0).y();
    Simulation simulation(m, nothing, settings);
    FrameReport r;
    double time = 0;
    for (const auto& [t, v, fall] :
         {std::array{0.1, .977865, .0489715}, std::array{0.5, 4.54613, 1.18002},
          std::array{1.0, 7.53498, 4.27510}, std::array{2.0, 9.61242, 13.1338}}) {
        r = simulation.advance(still(time), still(t));
        time = t;
        CHECK(-mean_velocity(m).y() == Approx(v).epsilon(0.005));
        CHECK(start - m.particle_position.at(0).y() == Approx(fall).epsilon(0.01));
    }
    CHECK(r.drag == Approx(r.gravity_work - r.kinetic).epsilon(0.01));
    CHECK(std::abs(r.remainder) < 0.01 * r.gravity_work);
}

TEST_CASE("what a medium takes is booked to the second order of the steps") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    Aggregate m = make_block(3, 3, 3, 0.05, springy(0));
    for (double& v : m.particle_velocity.y) v = -5;
    SimSettings settings = motion_settings(solver);
    settings.medium_density = 1000;
    settings.drag_coefficient = 1;
    const Apparatus nothing;
    Simulation simulation(m, nothing, settings);
    FrameReport r;
    for (int f = 0; f < 4; ++f) r = simulation.advance(still(0.01 * f), still(0.01 * (f + 1)));
    CHECK(r.drag > 0.2 * 0.5 * m.mass() * 25);
    CHECK(std::abs(r.remainder) < 0.002 * r.drag);
}

namespace {

// A thin plate, its normal tilted from the vertical by an angle about z.
Aggregate plate(double tilt) {
    Aggregate m = make_block(8, 1, 8, 0.05, springy(0.1));
    const Quat turn(Eigen::AngleAxisd(tilt, Vec3::UnitZ()));
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, turn * m.particle_reference.at(p));
    }
    return m;
}

}  // namespace

TEST_CASE("drag does not grow as the gap of a crack or a cut opens") {
    Aggregate m = make_block(2, 3, 2, 0.1, kSpringy);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(1, 0.5, 0));
    }
    SimSettings settings = motion_settings();
    settings.medium_density = 1;
    settings.directional_drag = 1;
    SurfaceDrag drag(m, settings, 1e-4);
    break_layer(m, 1);
    drag.connections_changed(m);
    const auto power = [&] {
        Vec3Array force;
        force.x = force.y = force.z = std::vector<double>(m.particle_count(), 0.0);
        return drag.add_forces(m, force).power;
    };
    const double before = power();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        if (m.particle_reference.at(p).y() > 0) m.particle_position.y[p] += 0.5;
    }
    CHECK(before > 0);
    CHECK(power() == Approx(before));
}

TEST_CASE("a drag too strong for its steps is bounded: it stops no particle within one") {
    Aggregate m = make_block(2, 2, 2, 0.1, kSpringy);
    SimSettings settings = motion_settings();
    settings.medium_density = 1000;
    settings.drag_coefficient = 1;
    constexpr double kStep = 1e-4;
    SurfaceDrag drag(m, settings, kStep);
    // The most that any particle loses of its speed, and whether that is bounded.
    const auto braked = [&](double speed) {
        for (double& v : m.particle_velocity.x) v = speed;
        Vec3Array force;
        force.resize(m.particle_count());
        const bool bounded = drag.add_forces(m, force).bounded;
        double most = 0;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            most = std::max(most, -force.x[p] * kStep / (m.particle_mass[p] * speed));
        }
        return std::pair(most, bounded);
    };
    const auto [most, bounded] = braked(1e6);
    CHECK(bounded);
    CHECK(most == Approx(0.75));  // a corner, of three faces a quarter each
    const auto [little, free] = braked(1);
    CHECK_FALSE(free);
    CHECK(little == Approx(braked(0.5).first * 2));
}

TEST_CASE("a medium meets what a cut has laid open") {
    Aggregate m = make_block(6, 4, 4, 0.1, kSpringy);
    for (std::size_t p = 0; p < m.particle_count(); ++p) m.particle_velocity.set(p, {2, 0, 0});
    SimSettings settings = motion_settings();
    settings.directional_drag = 3;
    SurfaceDrag drag(m, settings, 1e-4);
    const auto power = [&] {
        Vec3Array force;
        force.resize(m.particle_count());
        return drag.add_forces(m, force).power;
    };
    const double front = 16 * 0.01;  // [m2]
    CHECK(power() == Approx(3 * front * 2 * 2));
    sever_plane(m, Vec3(0.013, 0, 0), Vec3::UnitX());
    drag.connections_changed(m);
    CHECK(power() == Approx(2 * 3 * front * 2 * 2));  // each piece has a front
}

TEST_CASE("a plate sinks flat as fast as its weight over drag and area, and slower than on edge") {
    constexpr double kDrag = 5000, kSide = 0.4, kHeight = 0.05;
    for (const bool on_edge : {false, true}) {
        Aggregate m = plate(on_edge ? 0.5 * kPi : 0);
        SimSettings settings = motion_settings();
        settings.gravity = {0, -9.81, 0};
        settings.directional_drag = kDrag;
        const Apparatus nothing;
        Simulation simulation(m, nothing, settings);
        const double area = kSide * (on_edge ? kHeight : kSide);
        const double terminal = m.mass() * 9.81 / (kDrag * area), rate = 9.81 / terminal;
        const FrameReport r = simulation.advance(still(0), still(0.05));
        CHECK(-mean_velocity(m).y() ==
              Approx(terminal * (1 - std::exp(-0.05 * rate))).epsilon(0.02));
        CHECK(r.drag == Approx(r.gravity_work - r.kinetic - r.elastic).epsilon(0.03));
    }
}

TEST_CASE(
    "a tilted plate falls straight under drag against its motion, aside under drag along its "
    "normal") {
    constexpr double kTilt = 0.4;
    for (const DragAlong along : {DragAlong::motion, DragAlong::normal}) {
        Aggregate m = plate(kTilt);
        SimSettings settings = motion_settings();
        settings.gravity = {0, -9.81, 0};
        settings.directional_drag = 5000;
        settings.directional_drag_along = along;
        const Apparatus nothing;
        Simulation simulation(m, nothing, settings);
        simulation.advance(still(0), still(0.02));
        const Vec3 v = mean_velocity(m);
        CHECK(v.y() < -0.05);
        if (along == DragAlong::motion) {
            CHECK(std::abs(v.x()) < 0.02 * std::abs(v.y()));
        } else {
            // The lower side's normal (sin, -cos) is pushed back: up, and down the slope.
            CHECK(v.x() < -0.05 * std::abs(v.y()));
        }
    }
}

TEST_CASE("damping does not hold what flows: a body drawn to twice its length loses to its flow") {
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        Material material = springy(0.05);
        material.mechanics = mechanics;
        material.yield_stress = 1e4;
        Aggregate m = make_block(11, 3, 2, 0.1, material);
        const SteadyFlow drawn = flow_steadily(m, 0.7, 7000);
        CHECK(drawn.plastic > 0.5 * material.yield_stress * m.volume());
        CHECK(drawn.given > 0);
        // Strained as far as the matter they take 9 (cells) and 5 times what the flow does.
        CHECK(drawn.given < 0.04 * drawn.plastic);
        CHECK(drawn.stored < 0.002 * drawn.plastic);
    }
}

TEST_CASE(
    "what flows takes its branches along beside an inset that yields late, as it does alone") {
    Material material = springy(0.05), late = springy(0);
    material.yield_stress = 1e4;
    late.yield_stress = 30 * material.yield_stress;
    Aggregate alone = make_block(11, 3, 2, 0.1, material);
    Aggregate beside = alone;
    beside.inset.push_back(late);
    beside.cell_material.assign(beside.cell_fill.size(), 0);
    beside.cell_material[0] = 1;
    const double given = flow_steadily(alone, 0.3, 3000).given;
    CHECK(given > 0);
    // Its neighbours' branches are its own in part; did they fade as late, it would be 3.6 times.
    CHECK(flow_steadily(beside, 0.3, 3000).given == Approx(given).epsilon(0.15));
}

TEST_CASE("the drag on what broke in steps that are taken back is as it was before") {
    Material weak = springy(0);
    weak.strength = 1e4, weak.toughness = 10;
    Aggregate m = make_block(4, 3, 2, 0.1, weak);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(3, -1, 2) + m.particle_reference.at(p));
    }
    SimSettings settings = motion_settings();
    settings.medium_density = 1000;
    const Apparatus nothing;
    MovingBody body(m, 0, nothing, settings);
    BodyOutcome outcome(nothing, 0);
    body.find_forces(still(0), 0, outcome);
    const Vec3Array before = body.force();
    MovingBody::State state;
    body.save(state);
    break_layer(m, 1);
    body.connections_changed(still(0));
    body.find_forces(still(0), 0, outcome);
    CHECK(farthest_move(before, body.force()) > 0);
    body.restore(state, outcome);
    body.find_forces(still(0), 0, outcome);
    CHECK(farthest_move(before, body.force()) == 0);
}
