// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("grips that hold along different axes may hold the same, unless one turns") {
    const Aggregate body = test::make_block(8, 8, 8, 0.0125, Material{});
    MachineSpec spec;
    spec.name = "corner";
    for (const char* name : {"x", "y"}) {
        GripSpec grip;
        grip.name = name;
        grip.from = {"-length", "-height", "-width"};
        grip.to = {"length", "height", "width"};
        grip.along = {name[0] == 'x', name[0] == 'y', false};
        spec.grip.push_back(grip);
    }
    const auto stand = [&](const MachineSpec& one) {
        return build_machine(one, {}, place_work_frame(body), body);
    };
    CHECK(stand(spec).apparatus.grip[1].point.size() == body.surface.size());
    const auto refusal = Catch::Contains("grips x and y would hold the same points");
    for (const char* not_at_all : {"0 deg", "0.0", "0*t", "45 deg - 0.25*pi"}) {
        CAPTURE(not_at_all);
        MachineSpec straight = spec;
        straight.grip[1].motion.turn = not_at_all;
        CHECK_NOTHROW(stand(straight));
    }
    MachineSpec turned = spec;
    turned.grip[1].motion.turn = "t";
    CHECK_THROWS_WITH(stand(turned), refusal);
    spec.grip[1].along[0] = true;
    CHECK_THROWS_WITH(stand(spec), refusal);
}

TEST_CASE("a grip that moves along an axis which it does not hold is noted") {
    const Aggregate body = test::make_block(8, 8, 8, 0.0125, Material{});
    const auto notes = [&](std::array<bool, 3> along, const Expression3& move, const char* turn) {
        MachineSpec spec;
        spec.name = "plane";
        GripSpec& grip = spec.grip.emplace_back();
        grip.name = "side";
        grip.from = {"-length", "-height", "-width"};
        grip.to = {"-0.45*length", "height", "width"};
        grip.along = along;
        grip.motion.move = move;
        grip.motion.turn = turn;
        return build_machine(spec, {}, place_work_frame(body), body).notes;
    };
    const std::array<bool, 3> y = {false, true, false};
    const std::vector<std::string> idle = notes(y, {"length*t", "0", "0"}, "0 deg");
    REQUIRE(idle.size() == 1);
    CHECK(idle[0] ==
          "grip side holds along y alone (along), and moves along x: what it holds slides past it, "
          "so its motion does nothing");
    const std::vector<std::string> part = notes(y, {"length*t", "length*t", "length*t"}, "0");
    REQUIRE(part.size() == 1);
    CHECK(part[0] ==
          "grip side holds along y alone (along), and moves along x and z: what it holds slides "
          "past it, so that part of its motion does nothing");
    CHECK(notes(y, {"0", "length*t", "0"}, "0").empty());
    CHECK(notes(y, {"length*t", "0", "0"}, "t").empty());  // what it holds along turns with it
    CHECK(notes({true, true, true}, {"length*t", "0", "0"}, "0").empty());
}
