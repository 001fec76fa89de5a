// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/legs.h"

#include "tests/catch.h"
#include "tests/machines/bodies.h"

using namespace swage;

namespace {

// A grip that moves and turns, and one that stands.
Machine vice(const Expression& turn, const Expression& move = "0",
             const Expression& strength = "1") {
    MachineSpec spec;
    spec.name = "vice";
    spec.grip = vice_grips();
    spec.grip[1].motion.turn = turn;
    spec.grip[1].motion.move[0] = move;
    spec.gravity_strength = strength;
    const Aggregate body = bar();
    return build_machine(spec, {}, place_work_frame(body), body);
}

constexpr double kSlack = 1e-3;

// By straight legs, without missing what lies between their ends.
double turned_along(const Machine& machine, const Legs& legs) {
    double sum = 0;
    const std::vector<Drive> way = drives_of(machine, legs.leg, 1, 1);
    for (std::size_t n = 1; n < way.size(); ++n) {
        sum += way[n].world_from_grip[1].rotation.angularDistance(
            way[n - 1].world_from_grip[1].rotation);
    }
    return sum;
}

// Its strength over time, along straight legs.
double gravity_over(const Machine& machine, const Legs& legs) {
    double sum = 0;
    for (const Leg& leg : legs.leg) {
        sum += 0.5 * (leg.end - leg.begin) *
               (strengths_at(machine, leg.begin).back() + strengths_at(machine, leg.end).back());
    }
    return sum;
}

}  // namespace

TEST_CASE("what goes straight and evenly has one leg a frame, in their order") {
    const Legs legs = legs_of(vice("80 deg*t", "0.2*length*t", "t"), 7, kSlack, false);
    REQUIRE(legs.leg.size() == 7);
    CHECK(legs.lost == 0);
    for (int n = 0; n < 7; ++n) {
        CHECK(legs.leg[n].frame == n);
        CHECK(legs.leg[n].end == Approx((n + 1) / 7.0));
        CHECK(legs.leg[n].begin == (n > 0 ? legs.leg[n - 1].end : 0));
    }
}

TEST_CASE("turns are followed all round, however few the frames") {
    for (const double degrees : {100.0, 240.0, 360.0, 480.0, 7200.0}) {
        const Machine machine = vice(std::to_string(degrees) + " deg*t");
        for (int frames : {1, 2, 5, 60}) {
            const Legs legs = legs_of(machine, frames, kSlack, false);
            INFO(degrees << " degrees in " << frames << " frames");
            CHECK(legs.lost == (degrees / frames > 5760));
            if (legs.lost == 0) {
                CHECK(turned_along(machine, legs) == Approx(degrees * kPi / 180).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("what swings between two frames is followed, within what the slack allows") {
    for (int frames : {4, 10, 20}) {
        const Machine machine = vice("0", "0.1*length*sin(2*pi*10*t)", "sin(2*pi*10*t)");
        const Legs legs = legs_of(machine, frames, kSlack, false);
        INFO(frames);
        REQUIRE(legs.leg.size() > 100);
        for (const Leg& leg : legs.leg) {
            const Drive from = drive_at(machine, leg.begin, 1), to = drive_at(machine, leg.end, 1);
            for (double s : {0.1, 0.3, 0.6, 0.9}) {
                const Drive told = drive_between(from, to, s),
                            is = drive_at(machine, leg.begin + s * (leg.end - leg.begin), 1);
                CHECK((told.world_from_grip[1].translation - is.world_from_grip[1].translation)
                          .norm() <= 1.1 * kSlack);
                CHECK(std::abs(told.gravity_strength - is.gravity_strength) <= 0.011);
            }
        }
    }
}

TEST_CASE("the swings of tools and blades are followed as those of grips are") {
    MachineSpec still;
    still.name = "swing";
    still.grip = vice_grips();
    MotionSpec swing;
    swing.move[0] = "0.1*length*sin(2*pi*10*t)";
    MachineSpec with_tool = still, with_blade = still;
    ToolSpec tool;
    tool.name = "ball";
    tool.shape = ToolShape::sphere;
    tool.radius = "height";
    tool.at = {"0", "4*height", "0"};
    tool.motion = swing;
    with_tool.tool = {tool};
    BladeSpec blade;
    blade.name = "blade";
    blade.edge = {{"0", "4*height", "-width"}, {"0", "4*height", "width"}};
    blade.motion = swing;
    with_blade.blade = {blade};
    const Aggregate body = bar();
    for (const MachineSpec& spec : {with_tool, with_blade}) {
        const Machine machine = build_machine(spec, {}, place_work_frame(body), body);
        const Legs legs = legs_of(machine, 4, kSlack, false);
        REQUIRE(legs.leg.size() > 100);
        for (const Leg& leg : legs.leg) {
            const Drive from = drive_at(machine, leg.begin, 1), to = drive_at(machine, leg.end, 1),
                        is = drive_at(machine, 0.7 * leg.begin + 0.3 * leg.end, 1),
                        told = drive_between(from, to, 0.3);
            for (const auto poses : {&Drive::world_from_tool, &Drive::world_from_blade}) {
                for (std::size_t n = 0; n < (is.*poses).size(); ++n) {
                    const Vec3 off = (is.*poses)[n].translation - (told.*poses)[n].translation;
                    CHECK(off.norm() <= 1.1 * kSlack);
                }
            }
        }
    }
}

TEST_CASE("a jump or a kink takes few legs, and is where it is to within a 64th of a frame") {
    for (const char* strength : {"t < 0.37 ? 0 : 1", "max(0, t - 0.37)", "t < 0.4 ? 0 : 1"}) {
        const Legs legs = legs_of(vice("0", "0", strength), 10, kSlack, false);
        INFO(strength);
        CHECK(legs.lost == 0);
        CHECK(legs.leg.size() > 10);
        CHECK(legs.leg.size() <= 16);
    }
}

TEST_CASE("in motion a blow has its impulse, however short and wherever it falls") {
    for (const double length : {0.0005, 0.002, 0.011}) {
        for (int n = 0; n < 8; ++n) {
            const double begin = 0.1 + 0.00337 * n;
            const std::string strength = "t > " + std::to_string(begin) + " ? (t < " +
                                         std::to_string(begin + length) + " ? 1 : 0) : 0";
            const Machine machine = vice("0", "0", strength);
            const Legs legs = legs_of(machine, 60, kSlack, true);
            INFO(length << " from " << begin);
            CHECK(gravity_over(machine, legs) == Approx(length).margin(1.1 / (60 * 4096)));
            CHECK(legs.lost == 0);
            CHECK(legs.leg.size() < 60 + 50);
        }
    }
    const Machine machine = vice("0", "0", "sin(pi*t)");
    const Legs legs = legs_of(machine, 10, kSlack, true);
    CHECK(gravity_over(machine, legs) == Approx(2 / kPi).epsilon(1e-3));
}

TEST_CASE("what no leg can follow is told") {
    CHECK(legs_of(vice("0", "0", "sin(2*pi*1000*t)"), 4, kSlack, false).lost == 4);
}

TEST_CASE("how far a load may be off its way goes by its own full strength") {
    // A small pressure times large numbers, and the other way round.
    CHECK(legs_of(vice("0", "0", "2e5*ramp(t, 0, 1)"), 6, kSlack, false).leg.size() ==
          legs_of(vice("0", "0", "ramp(t, 0, 1)"), 6, kSlack, false).leg.size());
    const std::size_t swings =
        legs_of(vice("0", "0", "sin(2*pi*6*t)^2"), 6, kSlack, false).leg.size();
    CHECK(swings > 50);
    for (const char* strength : {"0.002*sin(2*pi*6*t)^2", "-7e3*sin(2*pi*6*t)^2"}) {
        const Legs legs = legs_of(vice("0", "0", strength), 6, kSlack, false);
        CHECK(legs.leg.size() == swings);
        CHECK(legs.lost == 0);
    }
    CHECK(legs_of(vice("0", "0", "0"), 6, kSlack, false).leg.size() == 6);
}

TEST_CASE("in motion grips keep the pace of their machine within legs and from one to the next") {
    struct Case {
        const char *turn, *move;
        double (*pace)(double);  // of the turn or the move at t, a second
    };
    for (const Case& c :
         {Case{"0", "length*t^2", [](double t) { return 2 * t; }},
          Case{"0", "0.1*length*sin(20*t)", [](double t) { return 2 * std::cos(20 * t); }},
          Case{"3*t^2", "0", [](double t) { return 6 * t; }},
          Case{"sin(9*t)", "0", [](double t) { return 9 * std::cos(9 * t); }}}) {
        const Machine machine = vice(c.turn, c.move);
        const bool turns = std::string(c.turn) != "0";
        const double scale = turns ? 1 : machine.frame.size.x();
        for (const int frames : {5, 12}) {
            const Legs legs = legs_of(machine, frames, kSlack, true);
            const std::vector<Drive> way = drives_of(machine, legs.leg, 1, 1);
            double most = 0, off = 0;
            for (std::size_t n = 1; n < way.size(); ++n) {
                const double step = 1e-3;
                for (const double s : {0.0, 0.2, 0.5, 0.8, 1 - step}) {
                    const Pose a = drive_between(way[n - 1], way[n], s).world_from_grip[1];
                    const Pose b = drive_between(way[n - 1], way[n], s + step).world_from_grip[1];
                    const double seconds = step * (way[n].time - way[n - 1].time);
                    const double gone =
                        turns ? turn_between(a, b).x() : (b.translation - a.translation).x();
                    const double t =
                        way[n - 1].time + (s + step / 2) * (way[n].time - way[n - 1].time);
                    most = std::max(most, std::abs(scale * c.pace(t)));
                    off = std::max(off, std::abs(gone / seconds - scale * c.pace(t)));
                }
            }
            INFO(c.turn << " " << c.move << " " << frames << " frames, " << way.size() - 1
                        << " legs");
            CHECK(off < 2e-3 * most);
            CHECK(legs.lost == 0);
        }
    }
}

TEST_CASE("what goes evenly has no bent ways, in motion either, and rests have none at all") {
    for (const char* turn : {"0", "2*t"}) {
        const Machine machine = vice(turn, "0.2*length*t");
        const Legs legs = legs_of(machine, 7, kSlack, true);
        CHECK(legs.leg.size() == 7);
        for (const Drive& drive : drives_of(machine, legs.leg, 1, 1)) {
            for (const auto& way : drive.grip_way) CHECK(!way);
        }
    }
    const Machine machine = vice("t^2", "0");
    for (const Drive& drive : drives_of(machine, legs_of(machine, 7, kSlack, false).leg, 1, 1)) {
        CHECK(drive.grip_way.empty());
    }
}

TEST_CASE(
    "what jumps or begins at an endless pace goes straight in motion, and no farther than there") {
    for (const char* move : {"0.1*length*step(t, 0.5)", "0.1*length*step(t, 0.437)",
                             "0.1*length*sqrt(t)", "t < 0.5 ? 0 : 0.1*length*t"}) {
        const Machine machine = vice("0", move);
        const double start = drive_at(machine, 0, 1).world_from_grip[1].translation.x(),
                     far = drive_at(machine, 1, 1).world_from_grip[1].translation.x() - start;
        for (const int frames : {1, 4, 10}) {
            const std::vector<Drive> way =
                drives_of(machine, legs_of(machine, frames, kSlack, true).leg, 1, 1);
            for (std::size_t n = 1; n < way.size(); ++n) {
                for (double s = 0; s < 1; s += 0.05) {
                    const Drive now = drive_between(way[n - 1], way[n], s);
                    const double at = now.world_from_grip[1].translation.x() - start;
                    CAPTURE(move, frames, n, s);
                    CHECK(at > -0.01 * far);
                    CHECK(at < 1.01 * far);
                }
            }
        }
    }
}
