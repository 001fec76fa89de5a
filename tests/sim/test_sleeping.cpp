// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Material kSoft{.young_modulus = 1e5,
                     .density = 1000,
                     .damping_ratio = 0.3,
                     .friction = 0.4,
                     .restitution = 0.1};

void shift(Aggregate& m, const Vec3& by) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, m.particle_position.at(p) + by);
    }
}

// Blocks above a floor whose top is y = 0 where it stands.
struct Ground {
    std::vector<Aggregate> body;
    Apparatus apparatus;
    SimSettings settings = motion_settings();
    std::unique_ptr<Simulation> simulation;
    Pose floor{Quat::Identity(), Vec3(0, -0.5, 0)};
    double time = 0;
    FrameReport last;

    explicit Ground(const std::vector<double>& heights, bool sleep = true,
                    const Material& material = kSoft) {
        settings.gravity = Vec3(0, -9.81, 0);
        settings.sleep = sleep;
        Tool plate{"floor", BoxShape{Vec3(10, 1, 10), 0}, 0.4};
        apparatus.name = "ground";
        apparatus.tool.push_back(plate);
        for (double y : heights) {
            body.push_back(make_block(3, 2, 3, 0.1, material));
            shift(body.back(), Vec3(0, y + 0.1, 0));
        }
    }
    Drive drive() const {
        Drive d = still(time);
        d.world_from_tool.push_back(floor);
        return d;
    }
    // One frame in which the floor moves by this.
    const FrameReport& go(double duration, const Vec3& way = Vec3::Zero()) {
        if (!simulation) {
            std::vector<Aggregate*> bodies;
            for (Aggregate& m : body) bodies.push_back(&m);
            simulation = std::make_unique<Simulation>(bodies, apparatus, settings);
        }
        const Drive from = drive();
        time += duration;
        floor.translation += way;
        last = simulation->advance(from, drive());
        return last;
    }
    const FrameReport& settle() {
        for (int n = 0; n < 200 && go(0.05).asleep < static_cast<int>(body.size()); ++n) continue;
        return last;
    }
};

double heaviest_remainder(const FrameReport& r) {
    double most = 0;
    for (const Books& b : r.body) most = std::max(most, std::abs(b.remainder));
    return most;
}

}  // namespace

TEST_CASE("what has come to rest sleeps where it would have stayed, and its books stay") {
    Ground sleeps({0.05, 0.32}), wakes({0.05, 0.32}, false);
    REQUIRE(sleeps.settle().asleep == 2);
    CHECK(sleeps.time > 1);
    const double before = heaviest_remainder(sleeps.last);
    const Vec3Array where = sleeps.body[1].particle_position;
    while (wakes.time < sleeps.time + 2) wakes.go(0.05);
    while (sleeps.time < wakes.time - 1e-9) sleeps.go(0.05);
    CHECK(sleeps.last.asleep == 2);
    CHECK(wakes.last.asleep == 0);
    CHECK(where.x == sleeps.body[1].particle_position.x);
    CHECK(sleeps.last.kinetic == 0);
    CHECK(heaviest_remainder(sleeps.last) == Approx(before).margin(1e-9));
    for (int b = 0; b < 2; ++b) {
        CHECK((sleeps.body[b].centre() - wakes.body[b].centre()).norm() < 1e-3 * 0.1);
    }
    for (const auto& [one, other] : {std::pair(sleeps.last.elastic, wakes.last.elastic),
                                     std::pair(sleeps.last.contact, wakes.last.contact),
                                     std::pair(sleeps.last.damped, wakes.last.damped)}) {
        CHECK(one == Approx(other).epsilon(0.01));
    }
}

TEST_CASE("a pebble that lands wakes what lies there, as if it had never slept") {
    const auto run = [](bool sleep) {
        Material stiffer = kSoft;
        stiffer.young_modulus = 1e6;
        stiffer.damping_ratio = 0.15;  // more creeps too long to sleep by then
        // With dull contacts the blow is another where a tremor has lifted the rim of what lay
        // there.
        stiffer.restitution = 1;
        auto ground = std::make_unique<Ground>(std::vector<double>{0, 15.0}, sleep, stiffer);
        int asleep = 0;
        while (ground->time < 1.79) asleep = std::max(asleep, ground->go(0.05).asleep);
        CHECK(asleep == (sleep ? 1 : 0));
        return ground;
    };
    const auto sleeps = run(true), wakes = run(false);
    CHECK(sleeps->last.asleep == 0);
    CHECK(sleeps->last.kinetic > 1);
    CHECK((sleeps->body[0].centre() - wakes->body[0].centre()).norm() < 1e-5 * 0.1);
    CHECK((sleeps->body[1].centre() - wakes->body[1].centre()).norm() < 1e-5 * 0.1);
    CHECK(heaviest_remainder(sleeps->last) ==
          Approx(heaviest_remainder(wakes->last)).margin(1e-7 * 18 * 9.81 * 15));
}

TEST_CASE("a sleeper wakes when its floor moves or its weight changes") {
    Ground ground({0.01});
    REQUIRE(ground.settle().asleep == 1);
    const double y = ground.body[0].centre().y();
    ground.go(0.1, Vec3(0, 0.05, 0));
    CHECK(ground.last.asleep == 0);
    CHECK(ground.body[0].centre().y() == Approx(y + 0.05).margin(0.02));
    REQUIRE(ground.settle().asleep == 1);
    CHECK(ground.body[0].centre().y() == Approx(y + 0.05).margin(1e-4));

    Drive lighter = ground.drive();
    const Drive now = lighter;
    lighter.time += 0.1;
    lighter.gravity_strength = 0;
    CHECK(ground.simulation->advance(now, lighter).asleep == 0);
    CHECK(ground.body[0].centre().y() > y + 0.05);
}

TEST_CASE("what swings, slides or stands at the top of its way does not sleep") {
    SECTION("thrown up") {
        Ground ground({0.5});
        for (double& v : ground.body[0].particle_velocity.y) v = 3;
        for (int n = 0; n < 60; ++n) CHECK(ground.go(0.01).asleep == 0);
    }
    SECTION("sliding on ice") {
        Material ice = kSoft;
        ice.friction = 0;
        Ground ground({0}, true, ice);
        ground.apparatus.tool[0].friction = 0;
        ground.settle();
        REQUIRE(ground.last.asleep == 1);
        Ground slow({0}, true, ice);
        slow.apparatus.tool[0].friction = 0;
        for (double& v : slow.body[0].particle_velocity.x) v = 0.002;
        const double from = slow.body[0].centre().x();
        for (int n = 0; n < 100; ++n) CHECK(slow.go(0.05).asleep == 0);
        CHECK(slow.body[0].centre().x() - from == Approx(0.01).epsilon(0.02));
    }
    SECTION("without gravity") {
        Ground ground({1});
        ground.settings.gravity.setZero();
        for (int n = 0; n < 40; ++n) CHECK(ground.go(0.05).asleep == 0);
    }
}

TEST_CASE("sleep gives equal bytes with one and two threads") {
    const auto run = [](int threads) {
        set_thread_count(threads);
        Ground ground({0.05, 0.32});
        ground.settle();
        set_thread_count(0);
        return std::pair(ground.body[1].particle_position.y, ground.time);
    };
    CHECK(run(1) == run(2));
}
