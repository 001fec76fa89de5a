// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/repeat.h"

#include "base/error.h"
#include "machines/machine.h"
#include "machines/parameters.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"

using namespace swage;

namespace {

// Rollers above the body, side by side, each turning about its own middle.
MachineSpec rollers() {
    MachineSpec spec;
    spec.name = "rollers";
    spec.parameter = {{"rolls", Quantity::number, "3", "0", "100", ""}};
    ToolSpec roll;
    roll.name = "roll";
    roll.repeat.count = "rolls";
    roll.shape = ToolShape::cylinder;
    roll.radius = "0.01*length*number";
    roll.length = "2*width";
    roll.at = {"0.2*length*(number - 2)", "height", "0"};
    roll.friction = "0.1*number";
    roll.motion.turn = "number*t";
    roll.motion.pivot = {"roll_x", "roll_y", "roll_z"};
    ToolSpec after;
    after.name = "after";
    after.shape = ToolShape::sphere;
    after.radius = "0.05*length";
    after.at = {"0", "-height", "0"};
    spec.tool = {roll, after};
    return spec;
}

Machine set_up(const MachineSpec& spec, const std::map<std::string, double>& given = {},
               const std::vector<Material>& beside = {}) {
    const Aggregate body = bar();
    return build_machine(spec, given, place_work_frame(body), body, beside);
}

}  // namespace

TEST_CASE("a repeated tool stands there as often as it says, each by its own number") {
    const Machine machine = set_up(rollers());
    const std::vector<Tool>& tool = machine.apparatus.tool;
    REQUIRE(tool.size() == 4);
    const Drive end = drive_at(machine, 1, 1);
    for (int n = 0; n < 3; ++n) {
        CHECK(tool[n].name == "roll_" + std::to_string(n + 1));
        CHECK(std::get<CylinderShape>(tool[n].shape).radius == Approx(0.01 * (n + 1)));
        CHECK(tool[n].friction == Approx(0.1 * (n + 1)));
        CHECK(machine.work_from_tool[n].translation.x() == Approx(0.2 * (n - 1)).margin(1e-12));
        // It stays where it is and turns.
        const Pose from = drive_at(machine, 0, 1).world_from_tool[n], to = end.world_from_tool[n];
        CHECK((to.translation - from.translation).norm() < 1e-12);
        CHECK(rotation_of(to.rotation * from.rotation.conjugate()).norm() == Approx(n + 1));
    }
    CHECK(tool[3].name == "after");
}

TEST_CASE("a repeated tool has the friction of its number on the bodies beside the work-piece") {
    MachineSpec spec = rollers();
    spec.tool[0].friction = "material_friction*number";
    Material beside;
    beside.friction = 0.05;
    const Machine machine = set_up(spec, {}, {beside});
    for (int n = 0; n < 3; ++n) {
        CHECK(machine.apparatus.tool[n].friction_on(1) == Approx(0.05 * (n + 1)));
    }
}

TEST_CASE("a count of 0 leaves the part out, and what is single already stays as it is") {
    CHECK(set_up(rollers(), {{"rolls", 0}}).apparatus.tool.size() == 1);
    const MachineSpec once = with_single_parts(rollers(), {{"rolls", 5}});
    REQUIRE(once.tool.size() == 6);
    const MachineSpec again = with_single_parts(once, {{"rolls", 2}});
    REQUIRE(again.tool.size() == 6);
    CHECK(again.tool[4].name == "roll_5");
    CHECK(again.tool[4].repeat.number == 5);
}

TEST_CASE("a count that rounding has put beside a whole number is that number") {
    MachineSpec spec = rollers();
    spec.parameter[0].quantity = Quantity::length;
    spec.tool[0].repeat.count = "rolls/(10 cm)";
    REQUIRE(0.3 / 0.1 != 3);
    CHECK(with_single_parts(spec, {{"rolls", 0.3}}).tool.size() == 4);
}

TEST_CASE("a count without a value is told as a mistake of the parameter") {
    MachineSpec spec = rollers();
    spec.tool[0].repeat.count = "6/(rolls - 2)";
    CHECK_THROWS_AS(with_single_parts(spec, {{"rolls", 2}}), ParameterError);
}

TEST_CASE("a count that is no whole number is told with the parameter that makes it so") {
    for (const double rolls : {2.5, -1.0, 101.0}) {
        try {
            with_single_parts(rollers(), {{"rolls", rolls}});
            FAIL("no mistake");
        } catch (const ParameterError& error) {
            CHECK(error.mistakes().front().parameter == "rolls");
            CHECK(
                std::string(error.what()) ==
                fmt::format("machine rollers: roll is repeated {} times (\"rolls\"): it must be a "
                            "whole number from 0 to 100",
                            rolls));
        }
    }
}

TEST_CASE("a part is called by its own name, and by that of those it is one of") {
    CHECK(is_called("roll_2", "roll_2"));
    CHECK(is_called("roll_2", "roll"));
    CHECK(is_called("roll_12", "roll"));
    CHECK_FALSE(is_called("roll_12", "roll_1"));
    CHECK_FALSE(is_called("roll", "roll_2"));
    CHECK_FALSE(is_called("roller", "roll"));
    CHECK_FALSE(is_called("roll_left", "roll"));
    CHECK_FALSE(is_called("roll_", "roll"));
}

TEST_CASE("a grip that is not drawn holds all the same") {
    MachineSpec spec;
    spec.name = "vice";
    spec.grip = vice_grips();
    const Machine drawn = set_up(spec);
    spec.grip[1].drawn = false;
    const Machine bare = set_up(spec);
    CHECK_FALSE(drawn.apparatus.grip[1].jaw.triangle.empty());
    CHECK(bare.apparatus.grip[1].jaw.triangle.empty());
    CHECK(bare.apparatus.grip[1].point == drawn.apparatus.grip[1].point);
}
