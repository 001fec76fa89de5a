// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"
#include "sim/lattice_sweep.h"
#include "sim/moving_body.h"
#include "tests/catch.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/machines.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("a free body falls as Galileo says") {
    Aggregate m = make_block(3, 2, 2, 0.1, kSpringy);
    SimSettings settings = motion_settings();
    settings.gravity = Vec3(0, -9.81, 0);
    const Apparatus nothing;
    Simulation simulation(m, nothing, settings);
    const FrameReport r = simulation.advance(still(0), still(0.5));
    // The step is of second order: exact for what grows with the time squared.
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const double fallen = m.particle_reference.at(p).y() - m.particle_position.y[p];
        CHECK(fallen == Approx(9.81 * 0.5 * 0.5 / 2).epsilon(1e-9));
    }
}

TEST_CASE("momentum, angular momentum and nearly energy are kept in free vibration") {
    Aggregate m = make_block(5, 2, 2, 0.1, kSpringy);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_velocity.set(p, Vec3(0.3, 0, 0) + Vec3(0, 0, 2).cross(x) +
                                       Vec3(0.5 * x.x(), std::sin(9 * x.x()), 0));
    }
    const auto momenta = [&] {
        std::pair<Vec3, Vec3> sum{Vec3::Zero(), Vec3::Zero()};
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 mv = m.particle_mass[p] * m.particle_velocity.at(p);
            sum.first += mv;
            sum.second += m.particle_position.at(p).cross(mv);
        }
        return sum;
    };
    const auto before = momenta();
    SimSettings settings = motion_settings();
    settings.step_safety = 0.2;  // the energy of symplectic Euler swings with the step
    const Apparatus nothing;
    Simulation simulation(m, nothing, settings);
    FrameReport r = simulation.advance(still(0), still(0.05));
    const double energy = r.kinetic + r.elastic;
    long steps = r.steps;
    for (int f = 1; f < 20; ++f) {
        r = simulation.advance(still(0.05 * f), still(0.05 * (f + 1)));
        steps += r.steps;
        CHECK(r.kinetic + r.elastic == Approx(energy).epsilon(0.03));
    }
    CHECK(steps > 500);
    const auto after = momenta();
    CHECK((after.first - before.first).norm() < 1e-11 * before.first.norm());
    CHECK((after.second - before.second).norm() < 1e-11 * before.second.norm());
}

TEST_CASE("the step is stable up to its bound and not far beyond it") {
    const auto grows = [](double safety) {
        Aggregate m = make_block(4, 4, 4, 0.1, kSpringy);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            m.particle_velocity.set(p, 1e-6 * Vec3(p % 2 ? 1 : -1, p % 3 ? 1 : -1, p % 5 ? 1 : -1));
        }
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        settings.retry_limit = 0;
        const Apparatus nothing;
        Simulation simulation(m, nothing, settings);
        const double duration = 400 * explicit_step(m, settings);
        try {
            const FrameReport r = simulation.advance(still(0), still(duration));
            double start = 0;
            for (double mass : m.particle_mass) start += 1.5 * mass * 1e-12;
            return r.rescued > 0 || r.kinetic + r.elastic > 2 * start;
        } catch (...) {
            return true;
        }
    };
    CHECK_FALSE(grows(0.99));
    CHECK(grows(1.3));
}

TEST_CASE("dashpots take exactly the energy that is missing") {
    Material damped = kSpringy;
    damped.damping_ratio = 0.1;
    Aggregate m = make_block(5, 2, 2, 0.1, damped);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(0.2 * m.particle_reference.at(p).x(), 0, 0));
    }
    const double start = kinetic_energy(m);
    SimSettings settings = motion_settings();
    settings.step_safety = 0.02;  // the sum over steps is of first order
    const Apparatus nothing;
    Simulation simulation(m, nothing, settings);
    const FrameReport r = simulation.advance(still(0), still(0.2));
    CHECK(r.damped > 0.1 * start);
    CHECK(r.kinetic + r.elastic + r.damped == Approx(start).epsilon(0.02));
}

TEST_CASE("an explicit twist, slow and damped, needs the torque of the relaxed one") {
    Material material = kSpringy;
    material.damping_ratio = 0.3;
    const double angle = 0.2;
    double torque[2];
    for (bool stepped : {false, true}) {
        Aggregate bar = make_block(16, 4, 4, 0.025, material);
        const Twister twister(bar, 0.2, 0.05);
        SimSettings settings = stepped ? motion_settings() : SimSettings{};
        settings.grip_stiffness = 2;
        settings.tolerance = 1e-3;
        Simulation simulation(bar, twister.apparatus, settings);
        FrameReport r;
        Drive from = twister.drive_at(0, angle);
        for (int f = 1; f <= 20; ++f) {
            Drive to = twister.drive_at(std::min(1.0, f / 10.0), angle);
            to.time = 0.1 * f;
            r = simulation.advance(from, to);
            from = to;
        }
        torque[stepped] = r.load[1].torque.x();
    }
    CHECK(torque[1] == Approx(torque[0]).epsilon(0.03));
}
