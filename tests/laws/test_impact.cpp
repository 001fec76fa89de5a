// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "laws/impact.h"
#include "tests/catch.h"

using namespace swage;

namespace {

ImpactLaw law_of(double k, double e, double friction = 0, double holding = 0, double hold = 0) {
    return {
        k,   e, restitution_loss(e), restitution_damping(e), friction, std::max(friction, holding),
        hold};
}

// A mass on the plane y = 0, in steps.
struct Stone {
    double mass, step;
    Vec3 x, v, anchor = Vec3::Zero(), gravity = Vec3::Zero(), pull = Vec3::Zero();
    ImpactHistory history{};
    double damped = 0, friction = 0, stored = 0;
    double normal = 0;

    void go(const ImpactLaw& law) {
        const Vec3 kicked = v + step * (gravity + pull / mass), was = v;
        if (!history.touches) anchor = x;
        const ImpactForce f = impact_force(
            law, {-x.y(), Vec3::UnitY(), v, kicked, anchor - x, 1 / mass, step}, history);
        v = kicked + step / mass * f.force;
        anchor = x + f.reach;
        x += step * v;
        history = f.history;
        // Half of what a force does is done before its time, half of it after.
        const Vec3 pushed = mass * gravity + pull, dashed = f.force - f.elastic;
        given += pending_given + 0.5 * step * pushed.dot(was);
        damped += pending_damped - 0.5 * step * dashed.dot(was);
        if (!f.history.touches) damped += parting_loss(bound, bond, was, step);
        pending_given = 0.5 * step * pushed.dot(v);
        pending_damped = -0.5 * step * dashed.dot(v);
        bond = f.bond, bound = f.bound;
        friction += f.friction;
        stored = f.stored;
        normal = f.normal;
        kinetic = 0.5 * mass * was.dot(v);
        if (!books_begun) start = kinetic + stored, given = damped = friction = 0;
        books_begun = true;
    }
    double energy() const { return 0.5 * mass * v.squaredNorm(); }
    double given = 0, pending_given = 0, pending_damped = 0, kinetic = 0, start = 0, bound = 0;
    Vec3 bond = Vec3::Zero();
    bool books_begun = false;
    double left_over() const { return start + given - kinetic - stored - damped - friction; }
};

double rebound(double e, double mass, double k, double speed) {
    const double step = 1e-4 * std::sqrt(mass / k);
    Stone stone{mass, step, Vec3::Zero(), Vec3(0, -speed, 0)};
    stone.x.y() = 1e-3 * step * speed;
    const ImpactLaw law = law_of(k, e);
    for (int n = 0; n < 2'000'000 && (n < 1000 || stone.x.y() <= 0); ++n) stone.go(law);
    return stone.v.y() / speed;
}

}  // namespace

TEST_CASE("a mass keeps the asked share of its speed, whatever its size, speed and stiffness") {
    for (double e : {0.2, 0.5, 0.8, 1.0}) {
        for (const auto& [m, k, v] :
             {std::array{1.0, 1e4, 1.0}, std::array{1e-3, 1e2, 30.0}, std::array{1e3, 1e8, 1e-3}}) {
            INFO(e << ' ' << m << ' ' << k << ' ' << v);
            CHECK(std::abs(rebound(e, m, k, v) - e) < 1e-6 * e);
        }
    }
    CHECK(rebound(0, 1, 1e4, 1) == Approx(kDullest).epsilon(0.01));
}

TEST_CASE("what is round keeps the asked share too, though its points come to touch one by one") {
    // `told`: those that touch anew know how fast those beside them were met.
    const auto share = [](double e, bool told) {
        constexpr int kPoints = 24;
        constexpr double kMass = 2, kStiffness = 1e4, kSpeed = 3;
        const double step = 1e-4 * std::sqrt(kMass / (kPoints * kStiffness));
        const ImpactLaw law = law_of(kStiffness, e);
        std::array<ImpactHistory, kPoints> history;
        double y = 1e-9, v = -kSpeed;
        for (int n = 0; n < 1'000'000 && (n < 1000 || y <= 0); ++n) {
            double met = 0, push = 0;
            for (const ImpactHistory& h : history) {
                if (told && h.touches && !h.rests) met = std::max(met, h.speed);
            }
            for (int p = 0; p < kPoints; ++p) {
                const Vec3 now(0, v, 0);
                const ImpactForce f = impact_force(law,
                                                   {.depth = -y - 5e-4 * p,
                                                    .normal = Vec3::UnitY(),
                                                    .now = now,
                                                    .velocity = now,
                                                    .reach = Vec3::Zero(),
                                                    .give = 1 / kMass,
                                                    .step = step,
                                                    .beside = met},
                                                   history[p]);
                push += f.force.y();
                history[p] = f.history;
            }
            v += step / kMass * push;
            y += step * v;
        }
        return v / kSpeed;
    };
    for (double e : {0.2, 0.5, 0.8}) {
        INFO(e);
        CHECK(std::abs(share(e, true) - e) < 0.002 * e);
        CHECK(share(e, false) < 0.996 * e);
    }
}

TEST_CASE("the loss is the root of its relation") {
    for (double e : {kDullest, 0.2, 0.5, 0.8, 0.99}) {
        const double beta = restitution_loss(e);
        CHECK(beta * (1 + e) == Approx(std::log((1 + beta) / (1 - beta * e))).epsilon(1e-9));
    }
    CHECK(restitution_loss(1) == 0);
    CHECK(restitution_loss(0) == restitution_loss(kDullest));
}

TEST_CASE("a contact never pulls unless it sticks, and never gives energy") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int run = 0; run < 60; ++run) {
        const double e = 0.5 * (1 + any(random)), hold = run % 3 == 0 ? 3.0 : 0.0;
        const double mu = 0.4 * (1 + any(random));
        const ImpactLaw law = law_of(1e3, e, mu, 1.3 * mu, hold);
        // A pulling force goes to and fro: all that the stone holds it was given.
        Stone stone{1, 1e-4, Vec3(0, 0.01 * any(random), 0),
                    Vec3(any(random), any(random), any(random))};
        const double depth = std::max(0.0, -stone.x.y());
        const double start = stone.energy() + 0.5 * law.stiffness * depth * depth;
        double given = 0, least = 0;
        double regained = 0, too_much = 0;  // by dashpots; held beyond what was put in [J]
        for (int n = 0; n < 60'000; ++n) {
            if (n % 3000 == 0) stone.pull = 8 * Vec3(any(random), any(random) - 0.4, any(random));
            const Vec3 before = stone.x;
            stone.go(law);
            given += stone.pull.dot(stone.x - before);
            least = std::min(least, stone.normal);
            const double slack = 0.02 * (start + std::abs(given));
            regained = std::max(-stone.damped - slack, regained);
            // A step may hold half a step's work of the spring back or before.
            too_much = std::max(stone.energy() - start - given - slack - 5e-3, too_much);
        }
        CHECK(least >= -hold);
        CHECK(regained < 1e-9);
        CHECK(too_much <= 0);
    }
}

TEST_CASE("what springs hold, dashpots and friction take is what was put in") {
    const auto left = [](double step, double e, double hold) {
        const ImpactLaw law = law_of(1e4, e, 0.3, 0.4, hold);
        Stone stone{1, step, Vec3(0, 0.05, 0), Vec3(1.3, -1, 0.4)};
        stone.gravity = Vec3(0, -10, 0);
        for (double t = 0; t < 2; t += step) stone.go(law);
        REQUIRE(stone.damped + stone.friction > 0.3);
        return std::abs(stone.left_over()) / stone.start;
    };
    for (double e : {0.0, 0.3, 0.8, 1.0}) {
        for (double hold : {0.0, 20.0}) {
            INFO(e << ' ' << hold);
            const double coarse = left(1e-3, e, hold), fine = left(1e-4, e, hold);
            CHECK(coarse < 0.01);
            CHECK(fine < std::max(5e-6, 0.02 * coarse));
        }
    }
}

TEST_CASE("without friction none takes anything, however far a point slides in a step") {
    const ImpactLaw law = {.stiffness = 1e5,
                           .restitution = 0.5,
                           .loss = restitution_loss(0.5),
                           .damping = restitution_damping(0.5),
                           .friction = 0,
                           .holding = 0,
                           .hold = 0};
    ImpactState at{.depth = 1e-3,
                   .normal = Vec3::UnitY(),
                   .now = Vec3(2, -0.1, 0.3),
                   .velocity = Vec3(2, -0.1, 0.3),
                   .reach = Vec3(-2.1e-4, 3e-5, -2.8e-5),  // about the step's way, back
                   .give = 100,
                   .step = 1e-4};
    for (const double step : {1e-4, 0.0}) {
        at.step = step;
        const ImpactForce f = impact_force(law, at, {.speed = 1, .touches = true});
        CHECK(f.friction == 0);
        CHECK(f.reach.isZero(0));
        CHECK(f.force.cross(at.normal).isZero(0));
    }
}

TEST_CASE("a stone stays below the static limit, slides at the kinetic one, and rests again") {
    const double g = 10, k = 1e4;
    const auto pushed = [&](double pull) {
        Stone stone{1, 1e-3, Vec3(0, -g / k, 0), Vec3::Zero()};
        stone.gravity = Vec3(0, -g, 0);
        const ImpactLaw law = law_of(k, 0.3, 0.3, 0.5);
        for (int n = 0; n < 400; ++n) {
            stone.pull = Vec3(pull * std::min(1.0, n / 300.0), 0, 0);
            stone.go(law);
        }
        const double speed = stone.v.x();
        for (int n = 0; n < 1000; ++n) stone.go(law);
        return std::pair(stone, (stone.v.x() - speed) / 1.0);
    };
    CHECK(std::abs(pushed(0.47 * g).first.v.x()) < 1e-6);
    CHECK(pushed(0.53 * g).second == Approx(0.23 * g).epsilon(0.01));
    // Without the pull it comes to rest, and then bears more than what it slid at.
    Stone stone = pushed(0.53 * g).first;
    const ImpactLaw law = law_of(k, 0.3, 0.3, 0.5);
    stone.pull.setZero();
    for (int n = 0; n < 4000; ++n) stone.go(law);
    CHECK(std::abs(stone.v.x()) < 1e-9);
    const double at = stone.x.x();
    for (int n = 0; n < 3000; ++n) {
        stone.pull = Vec3(0.45 * g * std::min(1.0, n / 1000.0), 0, 0);
        stone.go(law);
    }
    CHECK(std::abs(stone.x.x() - at) < 2 * 0.5 * g / k);
}

TEST_CASE("what sticks holds up to its tension and then lets go for good") {
    const double k = 1e4, hold = 5;
    const auto pulled = [&](double pull) {
        Stone stone{1, 1e-3, Vec3(0, -1e-4, 0), Vec3::Zero()};
        const ImpactLaw law = law_of(k, 0.2, 0.3, 0.3, hold);
        for (int n = 0; n < 4000; ++n) {
            stone.pull = Vec3(0, pull * std::min(1.0, n / 2000.0), 0);
            stone.go(law);
        }
        return stone;
    };
    CHECK(pulled(0.97 * hold).x.y() == Approx(0.97 * hold / k).epsilon(0.02));
    const Stone gone = pulled(1.03 * hold);
    CHECK_FALSE(gone.history.touches);
    CHECK(gone.x.y() > 0.1);
}

TEST_CASE("points of unequal stiffness that stick hold together what each of them would") {
    const std::array<double, 4> stiffness = {1e4, 0.9e4, 0.7e4, 0.53e4};
    constexpr double kHold = 5, kStep = 1e-4;
    double y = 0, v = 1e-3, most = 0;  // pulled off slowly
    std::array<ImpactHistory, 4> history;
    for (ImpactHistory& h : history) h.touches = true;
    for (int n = 0; n < 20'000; ++n, y += kStep * v) {
        double pull = 0;
        for (int p = 0; p < 4; ++p) {
            const Vec3 now(0, v, 0);
            const ImpactForce f =
                impact_force(law_of(stiffness[p], 1, 0.3, 0.3, kHold),
                             {-y, Vec3::UnitY(), now, now, Vec3::Zero(), 1, kStep}, history[p]);
            pull -= f.normal;
            history[p] = f.history;
        }
        most = std::max(most, pull);
    }
    CHECK(most == Approx(4 * kHold).epsilon(0.01));  // letting go at all it holds: 15.7
    CHECK(y > 2 * kHold / 0.53e4);
    for (const ImpactHistory& h : history) CHECK_FALSE(h.touches);
}

TEST_CASE("what a bond holds is the work that has drawn it out, also where it gives way") {
    constexpr double kStiffness = 2e3, kHold = 5;
    double work = 0;
    for (int n = 0; n < 1000; ++n) {
        const double from = -n * 5e-6, to = from - 5e-6;
        work -= spring_push(kStiffness, 0.5 * (from + to), kHold) * 5e-6;
        REQUIRE(spring_energy(kStiffness, to, kHold) == Approx(work).epsilon(1e-4));
    }
    CHECK(is_bound(kStiffness, -0.00499, kHold));
    CHECK_FALSE(is_bound(kStiffness, -0.00501, kHold));
    CHECK_FALSE(is_bound(kStiffness, -1e-9, 0));
}

TEST_CASE("dashpots of any size are stable in steps that the spring alone allows") {
    for (double loss : {0.0, 1.0, 1e3, 1e6}) {
        ImpactLaw law = law_of(1, 1, 0, 0, 1e9);  // never lets go
        law.loss = law.damping = loss;
        Stone stone{1, 1.9, Vec3(0, -1e-3, 0), Vec3(0, -1e-3, 0)};
        stone.gravity = Vec3(0, -0.05, 0);
        double highest = 0;
        for (int n = 0; n < 1000; ++n) stone.go(law), highest = std::max(highest, stone.x.y());
        CHECK(highest < 1);
    }
}
