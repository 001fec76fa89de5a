// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/resting_contacts.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 5e-3, kForce = 0.02;

// How far the end of a bar goes sideways that a grip holds up to `edge`, over a beam's bending.
double sag_over_beam(double edge) {
    const Material matter_of{.young_modulus = 1e9, .poisson_ratio = 0.3, .density = 1000};
    Aggregate bar = make_block(20, 4, 4, kCell, matter_of);
    const double end = 10 * kCell, free = end - edge, height = 4 * kCell;
    const auto at_end = points_where(bar, [&](const Vec3& x) { return x.x() > end - 1e-9; });
    Apparatus apparatus;
    apparatus.load.push_back(force_on(bar, at_end, {0, -kForce, 0}));
    Grip grip =
        hold(bar, points_where(bar, [&](const Vec3& x) { return x.x() < edge + 0.2499 * kCell; }));
    for (int p : grip.point) {
        const double low = bar.surface_position(p).x() - 0.25 * kCell;
        grip.share.push_back(std::min(1.0, (edge - low) / (0.5 * kCell)));
    }
    apparatus.grip.push_back(grip);
    SimSettings settings;
    settings.tolerance = 1e-3;
    put_on(bar, apparatus, settings, 1);
    double sag = 0;
    for (int p : at_end) sag -= (bar.surface_position(p) - bar.surface_reference(p)).y();
    sag /= static_cast<double>(at_end.size());
    const double stiffness = 1e9 * std::pow(height, 4) / 12;
    return sag * 3 * stiffness / (kForce * std::pow(free, 3));
}

}  // namespace

TEST_CASE("what a grip leaves free bends as its length says, wherever the edge cuts the cells") {
    double least = 1e9, most = 0;
    for (int n = 0; n <= 8; ++n) {
        const double sag = sag_over_beam((-3 + n / 8.0) * kCell);
        CAPTURE(n, sag);
        CHECK(sag > 1);
        CHECK(sag < 1.12);
        least = std::min(least, sag);
        most = std::max(most, sag);
    }
    CHECK(most < 1.045 * least);  // whole points: 1.13
}

TEST_CASE("one move to a few times the yield strain does the work that is stored and flows") {
    const Material metal{
        .young_modulus = 1e9, .poisson_ratio = 0.3, .density = 1000, .yield_stress = 1e6};
    constexpr double kLength = 0.4;
    for (const double beyond : {1.5, 2.5, 3.9, 8.0}) {
        Aggregate bar = make_block(8, 2, 2, kLength / 8, metal);
        const double far = beyond * 1e-3 * kLength;
        Apparatus apparatus;
        Drive from, to;
        to.time = 1;
        for (const double side : {-1.0, 1.0}) {
            Grip grip =
                hold(bar,
                     points_where(
                         bar, [&](const Vec3& x) { return side * x.x() > 0.5 * kLength - 1e-9; }),
                     Vec3::UnitX());
            apparatus.grip.push_back(grip);
            from.world_from_grip.push_back(Pose{});
            to.world_from_grip.push_back({Quat::Identity(), Vec3(0.5 * side * far, 0, 0)});
        }
        SimSettings settings;
        settings.grip_stiffness = 100;
        Simulation simulation(bar, apparatus, settings);
        const FrameReport r = simulation.advance(from, to);
        CAPTURE(beyond, r.work, r.elastic, r.plastic);
        CHECK(r.plastic > 0);
        CHECK(std::abs(r.remainder) < 0.06 * r.work);
    }
}

TEST_CASE("a grip that stands has not moved halfway, however it is turned") {
    const Aggregate bar = make_block(4, 2, 2, kCell, {.young_modulus = 1e9, .density = 1000});
    Apparatus apparatus;
    apparatus.grip.push_back(hold(bar, points_where(bar, [](const Vec3& x) { return x.x() < 0; })));
    RestingContacts contacts(bar, apparatus, SimSettings{});
    double farthest = 0;
    for (int n = 1; n < 40; ++n) {
        Drive from = drive_of(apparatus, 0, 0);
        from.world_from_grip[0] = {Quat(Eigen::AngleAxisd(0.1 * n, Vec3(1, 2, 3).normalized())),
                                   Vec3(0.1, 0.02 * n, -0.3)};
        Drive to = from;
        to.time = 1;
        const Drive middle = drive_between(from, to, 0.5);
        farthest = std::max(farthest, contacts.near_travel(from, middle));
        CHECK(contacts.stand_still(bar, from, middle));
        to.world_from_grip[0].translation.x() += 1e-6 * kCell;
        CHECK_FALSE(contacts.stand_still(bar, from, to));
    }
    CHECK(farthest > 0);
}

TEST_CASE("what a grip speeds up evenly bears its mass times that, however few the frames",
          "[stress]") {
    constexpr double kLeg = 0.1, kSpeedUp = 10;  // [m/s2]
    const Material rubber{
        .young_modulus = 1e7, .poisson_ratio = 0.3, .density = 1000, .damping_ratio = 0.05};
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    for (const int frames : {5, 11, 20}) {
        Aggregate cube = make_block(3, 3, 3, 0.04 / 3, rubber);
        Apparatus apparatus;
        apparatus.grip.push_back(
            hold(cube, points_where(cube, [&](const Vec3& x) { return x.x() < -0.02 + 1e-9; })));
        SimSettings settings;
        settings.solver = solver;
        Simulation simulation(cube, apparatus, settings);
        const auto drive_at = [&](int n) {
            const double h = kLeg / frames, v = kSpeedUp * h * h;  // a leg
            Drive drive = drive_of(apparatus, n * h, 1);
            drive.world_from_grip[0].translation.x() = 0.5 * v * n * n;
            drive.grip_way = {WayEnds{{Vec3::Zero(), Vec3((n - 1) * v, 0, 0)},
                                      {Vec3::Zero(), Vec3(n * v, 0, 0)}}};
            return drive;
        };
        FrameReport report;
        for (int n = 1; n <= frames; ++n) {
            report = simulation.advance(drive_at(n - 1), drive_at(n));
        }
        const double mass = cube.mass(), speed = kSpeedUp * kLeg;
        CAPTURE(frames);
        // Straight from frame to frame: 0.4 to 3 times that, and less than nothing.
        // Steps that energy chooses are of many lengths, which stirs the grip by itself.
        const double within = solver == Solver::explicit_steps ? 1e-4 : 0.1;
        CHECK(report.load[0].force.x() == Approx(mass * kSpeedUp).epsilon(within));
        CHECK(report.kinetic == Approx(0.5 * mass * speed * speed).epsilon(0.01));
        CHECK(std::abs(report.remainder) < 0.01 * report.kinetic);
    }
}
