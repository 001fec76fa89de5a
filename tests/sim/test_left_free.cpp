// SPDX-License-Identifier: GPL-3.0-or-later
// What grips leave free, and what loads and gravity push there.
#include "sim/free_pieces.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Guided {
    Aggregate matter = make_block(8, 3, 3, 0.05, kSoft);
    Apparatus apparatus;
    SimSettings settings;

    // On its lowest side.
    explicit Guided(const Vec3& axes) {
        apparatus.name = "guide";
        apparatus.grip.push_back(hold(
            matter, points_where(matter, [](const Vec3& x) { return x.y() < -0.0749; }), axes));
    }
    void push(double side, const Vec3& force) {
        apparatus.load.push_back(force_on(
            matter, points_where(matter, [&](const Vec3& x) { return side * x.x() > 0.1999; }),
            force));
    }
    Vec3 off() const {
        const LoadSet loads(apparatus, settings);
        FreePieces pieces(matter, apparatus);
        const Drive now = drive_of(apparatus, 1, 1);
        const bool goes = pieces.is_pushed_off(loads, now);
        const Vec3 push = pieces.push_off(loads, now);
        CHECK(goes == !push.isZero(0));
        return push;
    }
    Vec3 turn() const {
        const LoadSet loads(apparatus, settings);
        return FreePieces(matter, apparatus).turn_off(loads, drive_of(apparatus, 1, 1));
    }
};

}  // namespace

TEST_CASE("of a push only that counts which no grip bars, however it stands") {
    Guided body({0, 1, 0});
    body.push(1, {3, -4, 5});
    CHECK((body.off() - Vec3(3, 0, 5)).norm() < 1e-9);
    CHECK(body.turn().isZero(0));
    body.apparatus.grip[0].hold = {0, 1, 1};
    CHECK((body.off() - Vec3(3, 0, 0)).norm() < 1e-9);
    body.apparatus.grip[0].hold = {1, 1, 1};
    CHECK(body.off().isZero(0));
    // Of a second grip too, whose frame is turned.
    body.apparatus.grip[0].hold = {0, 1, 0};
    body.apparatus.grip.push_back(body.apparatus.grip[0]);
    const LoadSet loads(body.apparatus, body.settings);
    FreePieces pieces(body.matter, body.apparatus);
    Drive now = drive_of(body.apparatus, 1, 1);
    now.world_from_grip[1].rotation = turn_by({0.5 * kPi, 0, 0});  // its y is the world's z
    CHECK(pieces.is_pushed_off(loads, now));
    CHECK((pieces.push_off(loads, now) - Vec3(3, 0, 0)).norm() < 1e-9);
    now.world_from_grip[1].rotation = turn_by({0, 0, 0.5 * kPi});
    CHECK((pieces.push_off(loads, now) - Vec3(0, 0, 5)).norm() < 1e-9);
}

TEST_CASE("what is in balance goes nowhere, and a couple turns what it may turn") {
    Guided body({0, 1, 0});
    body.settings.gravity = {0, -9.81, 0};
    CHECK(body.off().isZero(0));
    body.push(1, {2, 0, 0});
    body.push(-1, {-2, 0, 0});
    CHECK(body.off().isZero(0));
    CHECK(body.turn().isZero(0));
    body.apparatus.load.clear();
    body.push(1, {0, 0, 2});
    body.push(-1, {0, 0, -2});
    CHECK(body.off().isZero(0));
    CHECK(body.turn().normalized().isApprox(-Vec3::UnitY(), 1e-6));
    body.apparatus.grip[0].hold = {0, 1, 1};
    CHECK(body.turn().isZero(0));
}

TEST_CASE("an equilibrium with no end of the way is given up at once, and the way is named") {
    Guided body({0, 1, 1});
    body.push(1, {-3, 0, 0});
    const std::string told = stopped_by(body.matter, body.apparatus, body.settings, 2);
    INFO(told);
    CHECK(told.find("the work-piece goes off at 1 s: loads push it with 1.5 N along the world's "
                    "-x, which its grips leave free") != std::string::npos);
    // A tool may stop it.
    Guided stopped({0, 1, 1});
    stopped.push(1, {-3, 0, 0});
    stopped.apparatus.tool.push_back({"stop", BoxShape{Vec3(0.1, 1, 1), 0.01}, 0});
    Simulation simulation(stopped.matter, stopped.apparatus, stopped.settings);
    const auto at = [&](int n) {
        Drive d = drive_of(stopped.apparatus, n, n);
        d.world_from_tool.push_back({Quat::Identity(), Vec3(-0.2501, 0, 0)});
        return d;
    };
    const FrameReport report = simulation.advance(at(0), at(1));
    CHECK(report.load.at(0).force.x() == Approx(3).epsilon(0.02));
}

TEST_CASE("a guided piece of several is left alone by what pushes it off, and told") {
    Guided body({0, 1, 1});
    sever_plane(body.matter, Vec3(0.013, 0, 0), Vec3::UnitX());
    const auto left = points_where(body.matter, [](const Vec3& x) { return x.x() < -0.1999; });
    body.apparatus.grip.push_back(hold(body.matter, left));
    body.push(1, {3, 0, 0});
    body.push(-1, {3, 0, 0});
    const FrameReport report = put_on(body.matter, body.apparatus, body.settings, 1);
    REQUIRE(report.warning.size() == 1);
    CHECK(report.warning[0].find("a piece would fall") == 0);
    CHECK(report.load.at(2).force.isZero(0));
    CHECK(report.load.at(3).force.x() == Approx(3));
}
