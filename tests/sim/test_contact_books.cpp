// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/machines.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("the books of each of two bodies that collide balance by what they pass to each other") {
    const auto worst = [](double safety) {
        Material dull = kSpringy;
        dull.restitution = 0.5;
        dull.friction = 0.4;
        Aggregate a = make_block(3, 3, 3, 0.1, dull), b = make_block(2, 2, 2, 0.1, dull);
        place(b, {Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())), Vec3(0.42, 0.1, 0.05)});
        for (std::size_t p = 0; p < b.particle_count(); ++p) b.particle_velocity.x[p] = -2;
        const double energy = 0.5 * b.mass() * 4;
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        const Apparatus nothing;
        Simulation simulation({&a, &b}, nothing, settings);
        FrameReport r;
        double most = 0;
        for (int n = 0; n < 10; ++n) {
            r = simulation.advance(still(0.01 * n), still(0.01 * (n + 1)));
            for (const Books& books : r.body) most = std::max(most, std::abs(books.remainder));
        }
        REQUIRE(r.body[0].passed > 0.05 * energy);  // they did meet
        return std::array{most / energy, std::abs(r.remainder) / energy};
    };
    const auto coarse = worst(0.8), fine = worst(0.2);
    for (int n = 0; n < 2; ++n) {
        INFO(n << ": " << coarse[n] << ' ' << fine[n]);
        CHECK(coarse[n] < 0.01);
        CHECK(fine[n] < 0.5 * coarse[n]);
    }
}

TEST_CASE("what bodies lose where they meet does not hang on which of them is named first") {
    Material dull = kSpringy;
    dull.restitution = 0.5;
    dull.friction = 0.4;
    dull.damping_ratio = 0.1;
    const auto collide = [&](bool turned) {
        Aggregate a = make_block(3, 3, 3, 0.1, dull), b = make_block(2, 2, 2, 0.1, dull);
        place(b, {Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())), Vec3(0.42, 0.1, 0.05)});
        for (double& v : b.particle_velocity.x) v = -2;
        std::vector<Aggregate*> bodies = {&a, &b};
        if (turned) std::swap(bodies[0], bodies[1]);
        const Apparatus nothing;
        Simulation simulation(bodies, nothing, motion_settings());
        FrameReport r;
        for (int n = 0; n < 10; ++n) {
            r = simulation.advance(still(0.01 * n), still(0.01 * (n + 1)));
        }
        return std::tuple(r, a.mean_velocity(), b.mean_velocity());
    };
    const auto [one, a, b] = collide(false);
    const auto [other, a2, b2] = collide(true);
    CHECK(one.damped > 0.1);
    CHECK(one.friction > 0.001);
    CHECK(other.damped == Approx(one.damped).epsilon(1e-6));
    CHECK(other.friction == Approx(one.friction).epsilon(1e-6));
    CHECK((a2 - a).norm() < 1e-6);
    CHECK((b2 - b).norm() < 1e-6);
}

TEST_CASE("what tumbling bodies leave in the books' remainder falls with the step") {
    const auto worst = [](double friction, double safety) {
        Material m = kSpringy;
        m.restitution = 0.5;
        m.friction = friction;
        Aggregate a = make_block(5, 2, 2, 0.1, m), b = make_block(3, 3, 3, 0.09, m);
        place(b,
              {Quat(Eigen::AngleAxisd(0.6, Vec3(1, 1, 0.3).normalized())), Vec3(0.15, 0.32, 0.05)});
        for (std::size_t p = 0; p < a.particle_count(); ++p) {
            a.particle_velocity.set(p,
                                    Vec3(0, 2, 0) + Vec3(0, 0, 6).cross(a.particle_position.at(p)));
        }
        for (std::size_t p = 0; p < b.particle_count(); ++p) {
            b.particle_velocity.set(p, Vec3(-0.5, -3, 0));
        }
        const double energy = kinetic_energy(a) + kinetic_energy(b);
        SimSettings settings = motion_settings();
        settings.step_safety = safety;
        const Apparatus nothing;
        Simulation simulation({&a, &b}, nothing, settings);
        double most = 0;
        for (int n = 0; n < 60; ++n) {
            const FrameReport r = simulation.advance(still(0.005 * n), still(0.005 * (n + 1)));
            most = std::max(most, std::abs(r.remainder));
        }
        return most / energy;
    };
    for (double friction : {0.0, 0.3}) {
        const double coarse = worst(friction, 0.4), fine = worst(friction, 0.025);
        INFO("friction " << friction << ": " << coarse << ' ' << fine);
        CHECK(coarse < 4e-3);
        CHECK(fine < 2e-4);
        CHECK(fine < 0.125 * coarse);
    }
}

TEST_CASE("the books of lumps that flatten each other, and stick, close") {
    const Material clay{.young_modulus = 3e6,
                        .poisson_ratio = 0.45,
                        .density = 1800,
                        .yield_stress = 3e4,
                        .damping_ratio = 0.02,
                        .friction = 0.5,
                        .restitution = 0.17,
                        .stickiness = 3e5};
    Aggregate a = make_block(7, 7, 7, 0.01, clay), b = make_block(5, 5, 5, 0.01, clay);
    place(b, {Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), Vec3(0.09, 0.005, 0.005)});
    for (std::size_t p = 0; p < a.particle_count(); ++p) a.particle_velocity.x[p] = 4;
    for (std::size_t p = 0; p < b.particle_count(); ++p) b.particle_velocity.x[p] = -6;
    const double energy = 0.5 * (16 * a.mass() + 36 * b.mass());
    const Apparatus nothing;
    Simulation simulation({&a, &b}, nothing, motion_settings());
    FrameReport r;
    for (int n = 0; n < 10; ++n) r = simulation.advance(still(0.002 * n), still(0.002 * (n + 1)));
    INFO("remainder " << r.remainder / energy << ", plastic " << r.plastic / energy);
    CHECK(r.plastic > 0.6 * energy);
    CHECK(std::abs(r.remainder) < 2e-3 * energy);
}

TEST_CASE("an edge that falls on small cells gains nothing from them, nor by frames") {
    Material m = kSpringy;
    m.restitution = 0.5;
    m.friction = 0.4;
    for (int finer : {2, 4, 8}) {
        Aggregate a = make_block(finer, finer, finer, 0.1 / finer, m),
                  b = make_block(3, 3, 3, 0.1, m);
        place(b, {Quat(Eigen::AngleAxisd(0.7, Vec3(0.2, 0, 1).normalized())),
                  Vec3(0.01, 0.291, 0.02)});
        const double energy = b.mass() * 10 * 0.01;
        Grip hold;
        hold.point = points_where(a, [](const Vec3& x) { return x.y() < -0.0499; });
        for (int p : hold.point) hold.anchor.push_back(a.surface_reference(p));
        Apparatus apparatus;
        apparatus.grip.push_back(hold);
        SimSettings settings = motion_settings();
        settings.gravity = Vec3(0, -10, 0);
        settings.step_safety = 0.2;
        Simulation simulation({&a, &b}, apparatus, settings);
        const auto drive = [](double time) {
            Drive d = still(time);
            d.world_from_grip.push_back({Quat::Identity(), Vec3::Zero()});
            return d;
        };
        double most = 0, bore = 0;
        long rejected = 0;
        for (int n = 0; n < 40; ++n) {
            const FrameReport r = simulation.advance(drive(0.005 * n), drive(0.005 * (n + 1)));
            most = std::max(most, std::abs(r.remainder));
            bore = std::max(bore, r.contact);
            rejected += r.rejected;
        }
        INFO("cells " << finer << " times as large: remainder " << most / energy);
        CHECK(bore > 0.1 * energy);
        CHECK(most < 3e-3 * energy);
        CHECK(rejected == 0);
    }
}

TEST_CASE(
    "a ball that is squeezed until its cells let go of points gains nothing as they come back") {
    const Material rubber{.elasticity = Elasticity::neo_hookean,
                          .young_modulus = 2e6,
                          .poisson_ratio = 0.49,
                          .density = 930,
                          .damping_ratio = 0.1,
                          .friction = 0.8};
    const double a = 0.05 / 7;
    Aggregate ball = make_shape([](const Vec3& p) { return (p - Vec3(0, .025, 0)).norm() - .025; },
                                Vec3(-.025, 0, -.025), Vec3i(7, 7, 7), a);
    const double full = ball.material.density;
    ball.material = rubber;
    for (double& m : ball.particle_mass) m *= rubber.density / full;
    for (const double speed : {5.0, 7.0, 10.0, 14.0}) {
        Aggregate pressed = ball,
                  weight =
                      make_block(4, 4, 4, 0.02,
                                 {.young_modulus = 1e8, .density = 7850, .damping_ratio = 0.02});
        place(weight, {Quat::Identity(), Vec3(0, .091, 0)});
        std::fill(weight.particle_velocity.y.begin(), weight.particle_velocity.y.end(), -speed);
        const double energy = 0.5 * weight.mass() * speed * speed;
        const Apparatus apparatus = floor_with(0.5);
        Simulation simulation({&pressed, &weight}, apparatus, motion_settings());
        FrameReport r;
        const double frame = 3.5e-3 / speed;
        for (int n = 0; n < 40; ++n) {
            r = simulation.advance(floor_at(frame * n), floor_at(frame * (n + 1)));
        }
        INFO(speed << " m/s: " << r.remainder / energy);
        CHECK(weight.particle_velocity.y[0] > 0.4 * speed);  // it was thrown back
        CHECK(std::abs(r.remainder) < 0.01 * energy);
    }
}

TEST_CASE("a plate that leaves an elastic block gets back what it put in") {
    // Within one move the plate goes ten times farther than it takes the block to spring back.
    for (const double friction : {0.0, 0.3}) {
        Aggregate block = make_block(4, 4, 4, 0.25, {.young_modulus = 1e7, .poisson_ratio = 0.3});
        const Press press{1};
        Apparatus apparatus = press.apparatus();
        for (Tool& tool : apparatus.tool) tool.friction = friction;
        Simulation simulation(block, apparatus, {.tolerance = 1e-3});
        const double down[] = {-0.05, 0.005, 0.01, -0.09, -0.1};  // of the side
        double put_in = 0;
        FrameReport report;
        for (int f = 1; f < 5; ++f) {
            report =
                simulation.advance(press.drive_at(f - 1, down[f - 1]), press.drive_at(f, down[f]));
            put_in = std::max(put_in, report.work);
            CHECK(std::abs(report.remainder) < 0.02 * put_in);
        }
        CHECK(report.load[1].contacts == 0);
        CHECK(put_in > 300);
        CHECK(std::abs(report.work - report.friction) < 0.02 * put_in);
    }
}

TEST_CASE("what a bar bent over rollers stores and slides away is what they put in") {
    Aggregate bar = make_block(40, 4, 4, 0.025, {.young_modulus = 1e7});
    const Bender bender{0.1, 0.2, 0.12, 0.045, kPi / 3, 0.3};
    const Apparatus apparatus = bender.apparatus();
    Simulation simulation(bar, apparatus, {.tolerance = 1e-3});
    FrameReport report;
    for (int f = 0; f < 24; ++f) {
        report = simulation.advance(bender.drive_at(f / 40.0), bender.drive_at((f + 1) / 40.0));
    }
    CHECK(report.friction > 0.2 * report.elastic);
    CHECK(std::abs(report.remainder) < 0.002 * report.work);
}
