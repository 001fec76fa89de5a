// SPDX-License-Identifier: GPL-3.0-or-later
// The energy books of bodies in motion.
#include "sim/moving_body.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

// A bar along x, its first swing along its axis: v = speed sin(pi x / L).
Aggregate swinging_bar(double speed, const Material& material = kSpringy) {
    Aggregate m = make_block(8, 2, 2, 0.1, material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const double x = m.particle_reference.at(p).x();
        m.particle_velocity.set(p, Vec3(speed * std::sin(kPi * x / 0.8), 0, 0));
    }
    return m;
}

void lift(Aggregate& m, double by) {
    for (double& y : m.particle_position.y) y += by;
}

double balance(const Books& b, double start) {
    return b.work + b.load_work + b.gravity_work + start - b.kinetic - b.elastic - b.contact -
           b.plastic - b.damped - b.friction - b.drag - b.fracture - b.severed_energy;
}

}  // namespace

TEST_CASE("free vibration keeps its energy to 0.1 % over 1000 periods") {
    Aggregate m = swinging_bar(0.05);
    const Apparatus nothing;
    Simulation simulation(m, nothing, motion_settings());
    const double period = 1.6 / std::sqrt(1e6 / 1000);
    const FrameReport first = simulation.advance(still(0), still(period));
    const double energy = first.kinetic + first.elastic;
    double farthest = 0;
    FrameReport r;
    for (int n = 1; n < 100; ++n) {
        r = simulation.advance(still(10 * (n - 1) * period + period),
                               still(10 * n * period + period));
        farthest = std::max(farthest, std::abs(r.kinetic + r.elastic - energy));
    }
    r = simulation.advance(still(991 * period), still(1000 * period));
    CHECK(std::abs(r.kinetic + r.elastic - energy) < 1e-3 * energy);
    CHECK(farthest < 1e-3 * energy);
    CHECK(std::abs(r.remainder) < 1e-3 * energy);
    CHECK(r.rejected == 0);
    CHECK(energy > 0.99 * 0.5 * 1000 * 0.032 * 0.5 * 0.05 * 0.05);
}

TEST_CASE("the remainder is what the books leave over, and falls with the square of the step") {
    double before = 0;
    for (const double safety : {0.8, 0.4, 0.2}) {
        Aggregate m =
            swinging_bar(2.0);  // strains of 8 %: the law bends, else there is no remainder
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        settings.gravity = {0, -9.81, 0};
        const Apparatus nothing;
        Simulation simulation(m, nothing, settings);
        double most = 0, start = 0;
        for (int n = 0; n < 20; ++n) {
            const FrameReport r = simulation.advance(still(0.004 * n), still(0.004 * (n + 1)));
            if (n == 0) start = r.remainder + r.kinetic + r.elastic - r.gravity_work;
            CHECK(balance(r, start) == Approx(r.remainder).margin(1e-9 * start));
            CHECK(balance(r.body[0], start) == Approx(r.body[0].remainder).margin(1e-9 * start));
            most = std::max(most, std::abs(r.remainder));
        }
        INFO("safety " << safety << ", remainder " << most << " of " << start);
        CHECK(most < 0.02 * safety * safety * start);
        if (before > 0) {
            CHECK(most < before / 2.5);
            CHECK(most > before / 8);
        }
        before = most;
    }
}

TEST_CASE("what damping takes stands in the books, at any step") {
    for (const double safety : {0.8, 0.2}) {
        Material material = kSpringy;
        material.damping_ratio = 0.1;
        Aggregate m = swinging_bar(0.02, material);
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        const Apparatus nothing;
        Simulation simulation(m, nothing, settings);
        const double energy = 0.25 * m.mass() * 0.02 * 0.02;
        const FrameReport r = simulation.advance(still(0), still(0.2));
        INFO("safety " << safety);
        CHECK(r.kinetic + r.elastic < 0.01 * energy);
        CHECK(r.damped == Approx(energy).epsilon(0.01));
        CHECK(std::abs(r.remainder) < 1e-4 * energy);
    }
}

TEST_CASE("what slides to rest gives its energy to friction, after the way that Coulomb says") {
    constexpr double kFriction = 0.3, kSpeed = 1;
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    Aggregate m = make_block(3, 2, 3, 0.1, material);
    lift(m, 0.1);
    for (double& v : m.particle_velocity.x) v = kSpeed;
    SimSettings settings = motion_settings();
    settings.gravity = {0, -9.81, 0};
    const Apparatus apparatus = floor_with(kFriction);
    Simulation simulation(m, apparatus, settings);
    const double time = kSpeed / (kFriction * 9.81);
    FrameReport r;
    for (int n = 0; n < 30; ++n) {
        r = simulation.advance(floor_at(0.05 * time * n), floor_at(0.05 * time * (n + 1)));
    }
    const double energy = 0.5 * m.mass() * kSpeed * kSpeed;
    double x = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        x += m.particle_mass[p] * (m.particle_position.x[p] - m.particle_reference.at(p).x());
    }
    CHECK(x / m.mass() == Approx(kSpeed * kSpeed / (2 * kFriction * 9.81)).epsilon(0.02));
    CHECK(r.friction == Approx(energy).epsilon(0.03));
    CHECK(r.kinetic < 1e-3 * energy);
    CHECK(r.contact > 0);
    CHECK(std::abs(r.remainder) < 0.01 * energy);
}

TEST_CASE("a bouncing body's energy passes through its contact, and comes back") {
    for (const double safety : {0.8, 0.2}) {
        Aggregate m = make_block(3, 3, 3, 0.1, kSpringy);
        lift(m, 0.25);
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        settings.gravity = {0, -9.81, 0};
        const Apparatus apparatus = floor_with(0);
        Simulation simulation(m, apparatus, settings);
        double most_contact = 0, most_remainder = 0, most_work = 0;
        const double energy = m.mass() * 9.81 * 0.1;
        for (int n = 0; n < 60; ++n) {
            const FrameReport r = simulation.advance(floor_at(0.01 * n), floor_at(0.01 * (n + 1)));
            most_contact = std::max(most_contact, r.contact);
            most_remainder = std::max(most_remainder, std::abs(r.remainder));
            most_work = std::max(most_work, std::abs(r.work));
        }
        INFO("safety " << safety << ", remainder " << most_remainder << " of " << energy);
        CHECK(most_contact > 0.01 * energy);
        CHECK(most_work < 1e-12 * energy);  // a floor that stands still does none
        CHECK(most_remainder < 0.03 * safety * energy);
    }
}
