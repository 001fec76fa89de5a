// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/sleeping.h"

#include <numbers>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/internal_damping.h"
#include "sim/moving_body.h"
#include "tests/catch.h"
#include "tests/sim/kinetic_energy.h"
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
    double weight = 1;           // gravity's strength
    std::optional<double> load;  // its strength, where there is one
    std::optional<double> lid;   // the height of the lower side of a plate above, likewise
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
        if (lid) d.world_from_tool.push_back({Quat::Identity(), Vec3(0, *lid + 0.5, 0)});
        d.gravity_strength = weight;
        if (load) d.load_strength.push_back(*load);
        return d;
    }
    // One frame in which the floor moves by this, and the lid sinks.
    const FrameReport& go(double duration, const Vec3& way = Vec3::Zero(), double sinks = 0) {
        if (!simulation) {
            std::vector<Aggregate*> bodies;
            for (Aggregate& m : body) bodies.push_back(&m);
            simulation = std::make_unique<Simulation>(bodies, apparatus, settings);
        }
        const Drive from = drive();
        time += duration;
        floor.translation += way;
        if (lid) *lid -= sinks;
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

// Whether a body that lies where it is, with this kinetic energy [J], rests by then.
bool rests_by(const Aggregate& m, double until, double kinetic, double gravity = 9.81) {
    Aggregate lies = m;
    SimSettings settings = motion_settings();
    settings.gravity = Vec3(0, -gravity, 0);
    Sleeping watch({&lies}, settings);
    bool rests = false;
    for (int n = 0; n <= 1000; ++n) rests = watch.rests(0, until * n / 1000, kinetic, gravity);
    return rests;
}

// A block on ice that nothing damps, which trembles a little as it falls asleep; and one above it
// that comes down, if anything does.
struct Trembling {
    std::unique_ptr<Ground> ground;
    double step;  // [s]

    explicit Trembling(std::optional<double> above = {}) {
        Material springy = kSoft;
        springy.friction = 0;
        Ground quiet({0}, true, springy);
        quiet.apparatus.tool[0].friction = 0;
        quiet.settings.contact_stiffness = 0.3;  // which damped and longer steps can follow alike
        REQUIRE(quiet.settle().asleep == 1);
        springy.damping_ratio = 0, springy.restitution = 1;
        std::vector<double> heights{0};
        if (above) heights.push_back(*above);
        ground = std::make_unique<Ground>(heights, true, springy);
        ground->apparatus.tool[0].friction = 0;
        ground->settings.contact_stiffness = quiet.settings.contact_stiffness;
        ground->body[0].particle_position = quiet.body[0].particle_position;
        shift(ground->body[0], Vec3(0, 1e-5, 0));
        step = 0.98 * explicit_step(ground->body[0], ground->settings);
    }
    // Frames of so many steps each, the floor sinking by this much in each step.
    const FrameReport& go(std::initializer_list<int> steps, double sinks = 0) {
        for (int n : steps) {
            ground->go(n * step, Vec3(0, -n * sinks, 0));
            CHECK(ground->last.steps == n);
        }
        return ground->last;
    }
};

Vec3 momentum(const Aggregate& m) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        sum += m.particle_mass[p] * m.particle_velocity.at(p);
    }
    return sum;
}

double fastest(const Aggregate& m) {
    double most = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        most = std::max(most, m.particle_velocity.at(p).norm());
    }
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

TEST_CASE("a sleeper wakes when a load on it changes, or its weight, however large and weak") {
    const double large = GENERATE(1.0, 1e8);
    Ground ground({0.01});
    ground.settings.gravity *= large;
    ground.weight = 1 / large;
    Aggregate& block = ground.body[0];
    ground.apparatus.load.push_back(push_below(block, large * 0.9 * block.mass() * 9.81));
    ground.load = 0;
    REQUIRE(ground.settle().asleep == 1);
    const Vec3 rest = block.centre();
    SECTION("a load") {
        Drive pushed = ground.drive();
        const Drive now = pushed;
        pushed.time += 0.2;
        pushed.load_strength = {1 / large};
        CHECK(ground.simulation->advance(now, pushed).asleep == 0);
        CHECK(block.centre().x() > rest.x() + 1e-3);
    }
    SECTION("weight") {
        Drive lighter = ground.drive();
        const Drive now = lighter;
        lighter.time += 0.1;
        lighter.gravity_strength = 0;
        CHECK(ground.simulation->advance(now, lighter).asleep == 0);
        CHECK(block.centre().y() > rest.y() + 1e-5);
    }
}

TEST_CASE("a load or weight has changed from more than a millionth of what it was on") {
    const Aggregate block = make_block(3, 2, 3, 0.1, kSoft);
    Apparatus apparatus;
    apparatus.load.push_back(push_below(block, 1));
    SimSettings settings = motion_settings();
    settings.gravity = Vec3(0, -9.81, 0);
    const LoadSet pushes(apparatus, settings);
    const auto is_stirred = [&](double load, double load_now, double weight, double weight_now) {
        Drive since = still(0), now = still(1);
        since.load_strength = {load}, now.load_strength = {load_now};
        since.gravity_strength = weight, now.gravity_strength = weight_now;
        return pushes.is_stirred(since, now);
    };
    for (const double s : {1.0, -1e-9, 1e9}) {
        CAPTURE(s);
        const double same = s * (1 + 0.9e-6), other = s * (1 + 1.1e-6);
        CHECK_FALSE(is_stirred(s, same, 1, 1));
        CHECK_FALSE(is_stirred(same, s, 1, 1));
        CHECK(is_stirred(s, other, 1, 1));
        CHECK(is_stirred(other, s, 1, 1));
        CHECK_FALSE(is_stirred(1, 1, s, same));
        CHECK(is_stirred(1, 1, s, other));
        CHECK(is_stirred(0, s, 1, 1));
        CHECK(is_stirred(1, 1, s, 0));
    }
    CHECK_FALSE(is_stirred(0, 0, 0, 0));
}

TEST_CASE("what falls under a millionth of its gravity does not sleep on its way") {
    const auto fall = [](bool sleep) {
        Ground ground({0.1}, sleep);
        ground.weight = 1e-6;
        const double from = ground.body[0].centre().y();
        for (int f = 0; f < 4; ++f) CHECK(ground.go(1.5).asleep == 0);
        return from - ground.body[0].centre().y();
    };
    const double fallen = fall(true);
    CHECK(fallen == fall(false));
    CHECK(fallen == Approx(0.5 * 9.81e-6 * 36).epsilon(1e-6));
}

TEST_CASE("a sleeper wakes when a tool comes down on it from far above, and bears it as if awake") {
    const auto press = [](bool sleep) {
        auto ground = std::make_unique<Ground>(std::vector<double>{0}, sleep);
        ground->apparatus.tool.push_back({"lid", BoxShape{Vec3(10, 1, 10), 0}, 0.4});
        ground->lid = 0.7;  // five cells above it
        while (ground->time < 9) ground->go(0.5);
        CHECK(ground->last.asleep == (sleep ? 1 : 0));
        ground->go(0.5, Vec3::Zero(), 0.51);
        CHECK(ground->last.asleep == 0);
        ground->go(0.5);
        return ground;
    };
    const auto sleeps = press(true), wakes = press(false);
    const double force = -sleeps->last.load[1].force.y();
    CHECK(force > 100);
    CHECK(force == Approx(-wakes->last.load[1].force.y()).epsilon(0.01));
    CHECK(sleeps->last.work == Approx(wakes->last.work).epsilon(0.01));
    CHECK((sleeps->body[0].centre() - wakes->body[0].centre()).norm() < 1e-3 * 0.1);
}

TEST_CASE("what a body still trembles by as it falls asleep stands in its books as damped") {
    Material springy = kSoft;
    springy.damping_ratio = 0.02, springy.restitution = 1;
    Ground ground({0}, true, springy);
    Simulation simulation(ground.body[0], ground.apparatus, ground.settings);
    const auto at = [&](double time) {
        Drive d = ground.drive();
        d.time = time;
        d.gravity_strength = std::min(1.0, time);  // hardly bounces
        return d;
    };
    FrameReport before, last;
    double time = 0;
    for (; last.asleep == 0 && time < 8; time += 0.02) {
        before = last;
        last = simulation.advance(at(time), at(time + 0.02));
    }
    const double trembles = std::abs(before.kinetic);
    REQUIRE(last.asleep == 1);
    REQUIRE(trembles > 1e-9 * ground.body[0].mass() * 9.81 * 0.1);
    CHECK(last.kinetic == 0);
    CHECK(std::abs(last.remainder - before.remainder) < 0.01 * trembles);
}

TEST_CASE("what lies still sleeps after ten times what it takes to fall by a cell, or to swing") {
    const Aggregate block = make_block(3, 2, 3, 0.1, kSpringy);
    const double fall = std::sqrt(2 * 0.1 / 9.81);  // by a cell [s]
    CHECK_FALSE(rests_by(block, 9.9 * fall, 0));
    CHECK(rests_by(block, 10.1 * fall, 0));
    CHECK_FALSE(rests_by(block, 1000, 0, 0));  // without gravity nothing lies
    CHECK(rests_by(block, 10.1 * 100 * fall, 0, 9.81e-4));
    CHECK_FALSE(rests_by(block, 9.9 * 100 * fall, 0, 9.81e-4));
    const Aggregate reed = make_block(40, 1, 1, 0.01, kSpringy);
    const double swing = 2 * std::numbers::pi / slowest_frequency(reed);
    REQUIRE(swing > 5 * std::sqrt(2 * 0.01 / 9.81));
    CHECK_FALSE(rests_by(reed, 9.9 * swing, 0));
    CHECK(rests_by(reed, 10.1 * swing, 0));
}

TEST_CASE("what trembles, slides or creeps does not sleep") {
    SECTION("trembling in its place") {
        const Aggregate block = make_block(3, 2, 3, 0.1, kSpringy);
        const double lifted = block.mass() * 9.81 * 0.1;  // by a cell [J]
        CHECK(rests_by(block, 10, 0.5e-6 * lifted));
        CHECK_FALSE(rests_by(block, 10, 2e-6 * lifted));
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
        // So slowly that the way tells, and not the energy.
        for (double& v : slow.body[0].particle_velocity.x) v = 0.001;
        const double from = slow.body[0].centre().x();
        for (int n = 0; n < 50; ++n) CHECK(slow.go(0.05).asleep == 0);
        CHECK(slow.last.kinetic < 0.6e-6 * slow.body[0].mass() * 9.81 * 0.1);
        CHECK(slow.body[0].centre().x() - from == Approx(0.0025).epsilon(0.02));
    }
    SECTION("one particle creeping") {
        Aggregate block = make_block(3, 2, 3, 0.1, kSpringy);
        SimSettings settings = motion_settings();
        settings.gravity = Vec3(0, -9.81, 0);
        Sleeping watch({&block}, settings);
        for (int n = 0; n <= 1000; ++n) {
            block.particle_position.x[5] += 1e-6;  // 0.1 mm a second
            REQUIRE_FALSE(watch.rests(0, 0.01 * n, 0, 9.81));
        }
    }
}

TEST_CASE("what wakes within a block of steps goes on as what wakes where one begins") {
    // By a millionth of a spacing in ten steps.
    const double sinks = 1.01e-8;
    Trembling within, apart;
    REQUIRE(within.ground->settle().asleep == 1);
    REQUIRE(apart.ground->settle().asleep == 1);
    REQUIRE(apart.go({9}, sinks).asleep == 1);
    CHECK(apart.go({21}, sinks).asleep == 0);
    CHECK(within.go({30}, sinks).asleep == 0);
    const Aggregate &one = within.ground->body[0], &other = apart.ground->body[0];
    const double weight = one.mass() * fastest(other);
    REQUIRE(weight > 0);
    CHECK((momentum(one) - momentum(other)).norm() < 1e-9 * weight);
    CHECK(kinetic_energy(one) == Approx(kinetic_energy(other)).epsilon(1e-9));
    CHECK(heaviest_remainder(within.ground->last) ==
          Approx(heaviest_remainder(apart.ground->last)).margin(1e-9 * weight));
}

TEST_CASE("what wakes as another comes near has not moved by the end of that step") {
    Trembling below(48.0);
    Ground& ground = *below.ground;
    while (ground.time < 3.049) ground.go(0.05);
    REQUIRE(ground.last.asleep == 1);
    while (ground.last.asleep == 1 && ground.time < 3.2) ground.go(5e-4);
    CHECK(ground.last.steps == 1);
    CHECK(ground.last.asleep == 0);
    CHECK(fastest(ground.body[0]) == 0);
    ground.go(5e-4);
    CHECK(fastest(ground.body[0]) > 0);
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
