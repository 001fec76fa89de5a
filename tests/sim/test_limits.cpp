// SPDX-License-Identifier: GPL-3.0-or-later
// Machines that come no farther once a tool or grip bears what it may.
#include "base/error.h"
#include "base/parallel.h"
#include "tests/catch.h"
#include "tests/sim/machines.h"
#include "tests/sim/pulled_bar.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.01, kLength = 10 * kCell, kArea = 4 * kCell * kCell;
const Material kElastic{.young_modulus = 1e9, .poisson_ratio = 0.3, .density = 1000};
const Material kMetal{.young_modulus = 1e9,
                      .poisson_ratio = 0.3,
                      .density = 1000,
                      .yield_stress = 2e6,
                      .hardening = 1e8};

Aggregate bar_of(const Material& material) { return make_block(10, 2, 2, kCell, material); }

enum class Ends { smooth, clamped };  // smooth ones leave it free to grow thinner

struct Pulled : PulledBar {
    explicit Pulled(const Material& material, double most = 0, Ends ends = Ends::smooth)
        : PulledBar(bar_of(material), kLength, 1e-4) {
        if (ends == Ends::smooth) {
            for (Grip& grip : apparatus.grip) grip.hold = Vec3(1, 0, 0);
        }
        if (most > 0) apparatus.limit.push_back({.part = 1, .most = most});
        start();
    }
    // In even moves; ends where a limit is reached.
    std::optional<LimitStop> go(double way, int moves) {
        for (int n = 1; n <= moves; ++n) {
            report.push_back(pull_to(way * n / moves));
            if (report.back().stop) return report.back().stop;
        }
        return std::nullopt;
    }
    std::vector<FrameReport> report;
};

double gap(const Aggregate& a, const Aggregate& b) {
    double most = 0;
    for (std::size_t p = 0; p < a.particle_count(); ++p) {
        most = std::max(most, (a.particle_position.at(p) - b.particle_position.at(p)).norm());
    }
    return most;
}

double length_of(const Aggregate& bar) {
    double low = 0, high = 0;
    for (double x : bar.particle_position.x) {
        low = std::min(low, x), high = std::max(high, x);
    }
    return high - low;
}

}  // namespace

TEST_CASE("an elastic bar pulled to a force has gone the way that Hooke's law says, from below") {
    const double force = 1e-3 * kElastic.young_modulus * kArea;
    Pulled bar(kElastic, force);
    const std::optional<LimitStop> stop = bar.go(0.05 * kLength, 7);
    REQUIRE(stop);
    CHECK(stop->beyond == 0);
    CHECK(stop->borne <= force);
    CHECK(stop->borne > 0.995 * force);
    CHECK(pull(bar.report.back()) == Approx(stop->borne));
    // True stress over the section that has grown thinner, and what both grips give way by.
    const double strain = stop->borne / (kElastic.young_modulus * kArea) * (1 + 0.6e-3);
    const double give = 2 * stop->borne * kCell / (100 * kElastic.young_modulus * kArea);
    const double way = stop->at.world_from_grip[1].translation.x();
    CHECK(way == Approx(std::expm1(strain) * kLength + give).epsilon(2e-3));
    CHECK(bar.report.back().load[1].pose.translation.x() == way);
    CHECK(bar.report.back().time == stop->at.time);

    // And goes back to where it was.
    Drive home = stop->at;
    home.time += 1;
    home.world_from_grip[1].translation.x() = 0;
    const FrameReport back = bar.simulation->advance(stop->at, home);
    CHECK_FALSE(back.stop);
    CHECK(std::abs(pull(back)) < 1e-3 * force);
    CHECK(gap(bar.matter, bar_of(kElastic)) < 1e-6 * kLength);
}

TEST_CASE("a bar of metal pulled to a stress and let go keeps the strain of its hardening law") {
    for (const double stress : {2.5e6, 3.5e6}) {
        Pulled bar(kMetal, stress * kArea);
        const std::optional<LimitStop> stop = bar.go(0.1 * kLength, 5);
        REQUIRE(stop);
        CHECK(stop->borne > 0.995 * stress * kArea);
        CHECK(stop->borne <= stress * kArea);
        // The law's stress is by the section that keeps the volume as it grows thinner.
        double kept = 0, now = stress;
        for (int n = 0; n < 20; ++n) {
            now = stop->borne / kArea * std::exp(kept + now / kMetal.young_modulus);
            kept = (now - kMetal.yield_stress) / kMetal.hardening;
        }
        Apparatus free;
        free.grip.push_back(bar.apparatus.grip[0]);
        Drive stands;
        stands.world_from_grip.resize(1);
        Simulation alone(bar.matter, free, bar.settings);
        Drive later = stands;
        later.time = 1;
        alone.advance(stands, later);
        CHECK(std::log(length_of(bar.matter) / kLength) == Approx(kept).epsilon(1e-3));
    }
}

TEST_CASE("the matter knows nothing of what was tried beyond the limit") {
    // One that was sent no farther in the first place.
    const double force = 3e6 * kArea;
    Pulled limited(kMetal, force, Ends::clamped), sent(kMetal, 0, Ends::clamped);
    const std::optional<LimitStop> stop = limited.go(0.4 * kLength, 2);
    REQUIRE(stop);
    sent.go(stop->at.world_from_grip[1].translation.x(), 2);
    CHECK(pull(sent.report.back()) == Approx(stop->borne).epsilon(1e-3));
    CHECK(gap(limited.matter, sent.matter) < 1e-5 * kLength);
    CHECK(limited.report.back().plastic == Approx(sent.report.back().plastic).epsilon(5e-3));
    CHECK(limited.report.back().work == Approx(sent.report.back().work).epsilon(5e-3));
    CHECK(limited.report.back().remainder < 0.01 * limited.report.back().work);
}

TEST_CASE("the first limit that is reached stops all, and none is looked at later") {
    const double force = 1e-3 * kElastic.young_modulus * kArea;
    Pulled bar(kElastic);
    bar.apparatus.limit = {{.part = 0, .most = 2 * force}, {.part = 1, .most = force}};
    bar.start();
    const std::optional<LimitStop> stop = bar.go(0.05 * kLength, 7);
    REQUIRE(stop);
    CHECK(stop->limit == 1);
    bar.drive = stop->at;
    CHECK_FALSE(bar.pull_to(0.05 * kLength).stop);
}

TEST_CASE("a limit that is not reached leaves what goes straight as it would be") {
    Pulled limited(kMetal, 100e6 * kArea, Ends::clamped), free(kMetal, 0, Ends::clamped);
    CHECK_FALSE(limited.go(0.05 * kLength, 5));
    free.go(0.05 * kLength, 5);
    CHECK(gap(limited.matter, free.matter) < 1e-9 * kLength);
}

TEST_CASE("what bears more than its limit from the start goes nowhere") {
    const double force = 1e-3 * kElastic.young_modulus * kArea;
    for (const bool anew : {false, true}) {  // let go of, and held where it lies
        Pulled bar(kElastic);
        bar.go(0.002 * kLength, 1);
        bar.apparatus.limit.push_back({.part = 1, .most = force});
        if (anew) {
            for (Grip& grip : bar.apparatus.grip) {
                grip.anchor.clear();
                for (int p : grip.point) grip.anchor.push_back(bar.matter.surface_position(p));
            }
            bar.drive.world_from_grip.assign(2, Pose{});
        }
        const Drive stands = bar.drive;
        bar.start();
        const FrameReport report = bar.pull_to(0.01 * kLength);
        REQUIRE(report.stop);
        CHECK(report.stop->borne > 1.5 * force);
        CHECK(report.stop->beyond == 0);
        CHECK(report.stop->at.time == stands.time);
        CHECK(report.load[1].pose.translation == stands.world_from_grip[1].translation);
    }
}

TEST_CASE("where a force jumps over its limit the way before that is kept, and told") {
    const double force = 1e-3 * kElastic.young_modulus * kArea;
    Pulled bar(kElastic, force);
    const auto at = [&](double time) {  // a little way, and from 0.3 s on more than is allowed
        Drive drive = bar.drive;
        drive.time = time;
        drive.world_from_grip[1].translation.x() =
            (1e-4 * time + (time < 0.3 ? 0.0 : 3e-3)) * kLength;
        return drive;
    };
    const FrameReport report = bar.simulation->advance(at(0), at(1), at);
    REQUIRE(report.stop);
    CHECK(report.stop->at.time == Approx(0.3).epsilon(1e-6));
    CHECK(report.stop->at.time < 0.3);
    CHECK(report.stop->borne < 0.1 * force);
    CHECK(report.stop->beyond > 2 * force);
    CHECK(length_of(bar.matter) / kLength - 1 < 1e-4);
}

TEST_CASE("a torque is that about the axis which a part turns about, wherever its frame stands") {
    const LoadLimit limit{.of_torque = true, .axis = {Vec3(0, 0, 1), Vec3(-0.2, 0, 0)}};
    const Pose pose{turn_about(Vec3::UnitX(), kPi / 2), Vec3(3, 4, 5)};
    const Vec3 force(7, -2, 11), torque(0.3, 0.4, 0.5), axis = pose.turn(limit.axis.along);
    const Vec3 of_axis = pose * limit.axis.at;
    const double about = (torque + (pose.translation - of_axis).cross(force)).dot(axis);
    CHECK(limit.borne(force, torque, pose) == Approx(std::abs(about)));
    CHECK(LoadLimit{}.borne(force, torque, pose) == Approx(force.norm()));
}

TEST_CASE("a plate presses a block to its limit, at any number of threads to the same bytes") {
    const auto press = [](int threads) {
        set_thread_count(threads);
        Aggregate block = make_block(6, 6, 6, 0.1 / 6, kMetal);
        const Press press{0.1};
        Apparatus apparatus = press.apparatus();
        apparatus.limit.push_back({.part = 1, .most = 25e3});
        Simulation simulation(block, apparatus, {});
        for (int n = 0; n < 10; ++n) {
            const FrameReport report = simulation.advance(press.drive_at(n, 0.01 * n),
                                                          press.drive_at(n + 1, 0.01 * (n + 1)));
            if (!report.stop) continue;
            CHECK(report.load[1].force.norm() <= 25e3);
            CHECK(report.load[1].force.norm() > 0.995 * 25e3);
            CHECK(report.stop->beyond == 0);
            break;
        }
        set_thread_count(0);
        return std::pair(state_hash(block), block.cell_history.empty());
    };
    const auto one = press(1);
    CHECK_FALSE(one.second);
    CHECK(one == press(2));
}

TEST_CASE("solvers of motion refuse limits") {
    Pulled bar(kElastic, 1);
    bar.settings.solver = Solver::explicit_steps;
    CHECK_THROWS_AS(bar.start(), Error);
}
