// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"

#include <filesystem>

#include "base/error.h"
#include "base/parallel.h"
#include "machines/touch.h"
#include "tests/catch.h"
#include "tests/machines/bodies.h"
#include "tests/shared/block.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

ParameterSpec parameter(const char* name, Quantity quantity, const char* value, const char* low,
                        const char* high) {
    return {name, quantity, value, low, high, ""};
}

// A roller under the body and one above that turns about the first and then lifts.
MachineSpec roller() {
    MachineSpec spec;
    spec.name = "roller";
    spec.parameter = {
        parameter("angle", Quantity::angle, "60 deg", "0 deg", "180 deg"),
        parameter("radius", Quantity::length, "0.2*length", "spacing", "length"),
        parameter("offset", Quantity::length, "2*radius", "", ""),
    };
    ToolSpec support;
    support.name = "support";
    support.shape = ToolShape::cylinder;
    support.radius = "radius";
    support.length = "2*width";
    support.at = {"0", "-height", "0"};
    support.touch = {"0", "1", "0"};
    ToolSpec pusher = support;
    pusher.name = "pusher";
    pusher.radius = "0.05*length";
    pusher.at = {"offset", "height", "0"};
    pusher.touch = {"0", "-1", "0"};
    pusher.friction = "0.7";
    pusher.motion.turn = "-angle*ramp(t, 0, 0.5)";
    pusher.motion.pivot = {"support_x", "support_y", "0"};
    pusher.motion.move = {"0", "height*ramp(t, 0.5, 1)", "0"};
    spec.tool = {support, pusher};
    return spec;
}

MachineSpec vice() {
    MachineSpec spec;
    spec.name = "vice";
    spec.grip = vice_grips();
    spec.grip[1].motion.turn = "450 deg*ramp(t, 0, 1)";
    spec.grip[1].motion.move = {"0.1*length*ramp(t, 0, 1)", "0", "0"};
    return spec;
}

Machine set_up(const MachineSpec& spec, const Aggregate& body = bar(),
               const std::map<std::string, double>& given = {}) {
    return build_machine(spec, given, place_work_frame(body), body);
}

std::string refusal(const MachineSpec& spec, const std::map<std::string, double>& given = {},
                    const Aggregate& body = bar()) {
    try {
        set_up(spec, body, given);
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::scene);
        return error.what();
    }
    return "";
}

bool says(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words) {
        if (text.find(word) == std::string::npos) {
            UNSCOPED_INFO("'" << text << "' lacks '" << word << "'");
            return false;
        }
    }
    return true;
}

}  // namespace

TEST_CASE("parameters take their defaults from the body and from earlier parameters") {
    const Machine machine = set_up(roller(), bar(), {{"radius", 0.22}});
    CHECK(machine.parameter.at("angle") == Approx(kPi / 3));
    CHECK(machine.parameter.at("radius") == 0.22);
    CHECK(machine.parameter.at("offset") == Approx(0.44));
    CHECK(set_up(roller()).parameter.at("offset") == Approx(0.4));
}

TEST_CASE("a parameter out of range is refused with its name, value and range in its own unit") {
    CHECK(says(refusal(roller(), {{"angle", 200 * kPi / 180}}),
               {"roller", "angle", "200 deg", "0 deg to 180 deg"}));
    CHECK(says(refusal(roller(), {{"radius", 0.001}}),
               {"roller", "radius", "1 mm", "1.25 cm to 1 m"}));
    CHECK(says(refusal(roller(), {{"radius", std::nan("")}}), {"roller", "radius"}));
    CHECK(says(refusal(roller(), {{"angel", 1}}), {"roller", "angel"}));
    CHECK(refusal(roller(), {{"angle", kPi}}) == "");
    CHECK(refusal(roller(), {{"angle", std::nextafter(180 * kPi / 180, 4)}}) == "");  // rounded
    CHECK(refusal(roller(), {{"offset", -0.3}}) == "");
    MachineSpec bad_default = roller();
    bad_default.parameter[0].default_value = "-1 deg";
    CHECK(says(refusal(bad_default), {"roller", "default", "angle", "-1 deg"}));
}

TEST_CASE("tools are brought up to the body, whatever way it lies") {
    for (int axis = 0; axis < 3; ++axis) {
        const Aggregate body = bar(axis, {1, 2, 3});
        const Machine machine = set_up(roller(), body);
        CHECK(machine.work_from_tool[0].translation.y() == Approx(-0.05 - 0.2).margin(1e-8));
        CHECK(machine.work_from_tool[1].translation.y() == Approx(0.05 + 0.05).margin(1e-8));
        const Drive drive = drive_at(machine, 0, 1);
        for (int tool = 0; tool < 2; ++tool) {
            const double room =
                nearest_distance(machine.apparatus.tool[tool].shape, drive.world_from_tool[tool],
                                 surface_positions(body));
            CHECK(room == Approx(0).margin(1e-8));
        }
    }
}

TEST_CASE("a tool that turns about another's axis keeps its distance and turns by the angle") {
    const Machine machine = set_up(roller(), bar(0, {5, 5, 5}));
    const Pose support = drive_at(machine, 0, 1).world_from_tool[0];
    const Pose start = drive_at(machine, 0, 1).world_from_tool[1];
    const Pose end = drive_at(machine, 0.5, 1).world_from_tool[1];
    const Vec3 before = start.translation - support.translation;
    const Vec3 after = end.translation - support.translation;
    CHECK(after.norm() == Approx(before.norm()));
    CHECK(std::atan2(before.y(), before.x()) - std::atan2(after.y(), after.x()) == Approx(kPi / 3));
    CHECK(start.rotation.angularDistance(end.rotation) == Approx(kPi / 3));
    // Afterwards it lifts, straight up.
    const Pose lifted = drive_at(machine, 1, 1).world_from_tool[1];
    CHECK((lifted.translation - end.translation - Vec3(0, 0.1, 0)).norm() < 1e-12);
}

TEST_CASE("a tool is turned about its own axis before that points anywhere") {
    MachineSpec spec;
    ToolSpec tool;
    tool.name = "plate";
    tool.shape = ToolShape::box;
    tool.size = {"0.1", "0.2", "0.3"};
    tool.axis = {"1", "0", "0"};
    spec.parameter = {parameter("angle", Quantity::angle, "0", "", "")};
    tool.turn = "angle";
    spec.tool = {tool};
    const Quat rest = set_up(spec).work_from_tool[0].rotation;
    for (const double angle : {0.0, 0.3, kPi / 2}) {
        const Quat turned = set_up(spec, bar(), {{"angle", angle}}).work_from_tool[0].rotation;
        CHECK((turned * Vec3::UnitZ() - Vec3::UnitX()).norm() < 1e-15);
        const Vec3 wanted =
            std::cos(angle) * (rest * Vec3::UnitX()) + std::sin(angle) * (rest * Vec3::UnitY());
        CHECK((turned * Vec3::UnitX() - wanted).norm() < 1e-15);
    }
}

TEST_CASE("a motion's axis goes by parameters, and has to have a length") {
    MachineSpec spec = roller();
    spec.parameter.push_back(parameter("tilt", Quantity::angle, "0", "", ""));
    spec.tool[1].motion.axis = {"0", "sin(tilt)", "cos(tilt)"};
    const Machine machine = set_up(spec, bar(), {{"tilt", 0.25}});
    const Pose start = machine.tool_motion[1].at(0), end = machine.tool_motion[1].at(0.5);
    const Vec3 turn = turn_between(start, end);
    CHECK((turn.normalized() + Vec3(0, std::sin(0.25), std::cos(0.25))).norm() < 1e-12);
    spec.tool[1].motion.axis = {"0", "0", "tilt"};
    CHECK(refusal(spec, {{"tilt", 0.0}}).find("the axis of a motion has no length") !=
          std::string::npos);
}

TEST_CASE("tools rub as their machine says, or else as the material") {
    Aggregate body = bar();
    body.material.friction = 0.45;
    const Machine machine = set_up(roller(), body);
    CHECK(machine.apparatus.tool[0].friction == 0.45);
    CHECK(machine.apparatus.tool[1].friction == 0.7);
    MachineSpec greased = roller();
    greased.tool[0].friction = "material_friction/3";
    CHECK(set_up(greased, body).apparatus.tool[0].friction == Approx(0.15));
}

TEST_CASE("what a machine checks is told also where it cannot be set up") {
    MachineSpec spec = roller();
    spec.check = {{"radius > length", "the rolls are thin"},
                  {"radius < length", "the rolls are thick"},
                  {"pusher_x > length", "the pusher is near"}};
    CHECK(set_up(spec).notes ==
          std::vector<std::string>{"the rolls are thin", "the pusher is near"});
    spec.tool[1].at[0] = "3*length";
    const std::string told = refusal(spec);
    CHECK(says(told, {"never touch", "the rolls are thin"}));
    for (const char* other : {"the rolls are thick", "the pusher is near"}) {
        CHECK(told.find(other) == std::string::npos);
    }
}

TEST_CASE("tools that cannot be are refused by name") {
    MachineSpec spec = roller();
    spec.tool[1].at[0] = "3*length";
    CHECK(says(refusal(spec), {"roller", "pusher", "never touch"}));
    spec = roller();
    spec.tool[1].radius = "0.001*length";
    for (const char* offset : {"0.004*length", "0.096*length"}) {
        spec.tool[1].at[0] = offset;
        const std::string told = refusal(spec);
        CHECK(says(told, {"roller", "pusher", "They lie about", "thicker"}));
        CHECK(told.find("never") == std::string::npos);
    }
    spec = roller();
    spec.tool[0].radius = "0";
    CHECK(says(refusal(spec), {"roller", "support", "radius"}));
    spec = roller();
    spec.tool[0].shape = ToolShape::none;
    CHECK(says(refusal(spec), {"roller", "support", "no shape"}));
    spec = roller();
    spec.tool[0].shape = ToolShape::box;
    spec.tool[0].size = {"3 cm", "2 cm", "4 cm"};
    spec.tool[0].rounding = "1 cm";
    CHECK(refusal(spec) == "");
    spec.tool[0].rounding = "1.01 cm";
    CHECK(says(refusal(spec), {"roller", "rounding", "support", "1.01 cm", "half"}));
    spec = roller();
    spec.tool[0].radius = "2 cm";
    spec.tool[0].length = "3 cm";
    spec.tool[0].rounding = "1.5 cm";
    CHECK(refusal(spec) == "");
    spec.tool[0].rounding = "1.51 cm";
    CHECK(says(refusal(spec), {"roller", "rounding", "support", "1.51 cm", "half of its length"}));
    spec.tool[0].rounding = "0.6 cm";
    spec.tool[0].hole = "1 cm";
    CHECK(says(refusal(spec), {"roller", "rounding", "support", "6 mm", "half of its wall"}));
    spec.tool[0].rounding = "0.5 cm";
    CHECK(refusal(spec) == "");
    spec.tool[0].hole = "2 cm";
    CHECK(says(refusal(spec), {"roller", "hole", "support", "2 cm", "radius"}));
    spec.tool[0].hole = "-1 mm";
    CHECK(says(refusal(spec), {"roller", "hole", "support", "radius"}));
    spec = roller();
    spec.tool[1].friction = "-1";
    CHECK(says(refusal(spec), {"roller", "pusher", "friction"}));
    spec = roller();
    spec.tool[1].at[0] = "nonsense*2";
    CHECK(refusal(spec) != "");
}

TEST_CASE("a mesh that encloses nothing is refused as a tool, with the reason") {
    const Scratch scratch;
    MachineSpec spec = roller();
    spec.tool[0].shape = ToolShape::mesh;
    spec.tool[0].mesh =
        scratch.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n");
    spec.tool[0].length = "length";
    const std::string told = refusal(spec);
    INFO(told);
    CHECK(says(told, {"tool support", "encloses nothing", "closed surface", "thicker"}));
}

TEST_CASE("a tool that starts inside the body is noted") {
    MachineSpec spec = roller();
    CHECK(set_up(spec).notes.empty());
    spec.tool[0].touch = {"0", "0", "0"};
    const Machine machine = set_up(spec);
    REQUIRE(machine.notes.size() == 1);
    CHECK(says(machine.notes[0], {"support", "deep"}));
}

TEST_CASE("a check that does not hold becomes a note, and may use where tools came to stand") {
    MachineSpec spec = roller();
    spec.check = {{"support_y < -height", "the support is too small"},
                  {"abs(pusher_y - 0.05*length - 0.5*height) < 1e-6", "never seen"},
                  {"offset > length", "the offset is too small"}};
    CHECK(set_up(spec).notes == std::vector<std::string>{"the offset is too small"});
}

TEST_CASE("a grip holds the points in its box where they are") {
    const Aggregate body = bar(2, {4, 4, 4});
    const Machine machine = set_up(vice(), body);
    const Drive drive = drive_at(machine, 0, 1);
    for (std::size_t g = 0; g < 2; ++g) {
        const Grip& grip = machine.apparatus.grip[g];
        // A tenth of 80 slices and the first, 32 points around; the end face is full.
        CHECK(grip.point.size() == 8 * 32 + 81);
        for (std::size_t n = 0; n < grip.point.size(); ++n) {
            const Vec3 held = drive.world_from_grip[g] * grip.anchor[n];
            CHECK((held - body.surface_position(grip.point[n])).norm() < 1e-12);
        }
        CHECK_FALSE(grip.jaw.triangle.empty());
    }
}

TEST_CASE("a grip holds what lies in its box, wherever its edge runs, and its jaws end there") {
    const Aggregate body = test::make_block(80, 8, 8, 0.0125, Material{});
    const Box box = box_of(surface_positions(body));
    const double around = 2 * (box.size().y() + box.size().z());
    for (const double edge : {-0.4, -0.396, -0.39, -0.3871, -0.31}) {
        MachineSpec spec = vice();
        spec.grip[0].to[0] = fmt::format("{}*length", edge);
        const Machine machine = set_up(spec, body);
        const Grip& grip = machine.apparatus.grip[0];
        double area = 0;
        for (std::size_t n = 0; n < grip.point.size(); ++n) {
            const int p = grip.point[n];
            if (std::abs(body.surface.normal(p).x()) > 0.5) continue;  // of the end
            area += grip.share_of(n) * body.surface.area(p);
        }
        const double length = (edge + 0.5) * box.size().x();
        CHECK(area == Approx(around * length).epsilon(0.01 * 0.0125 / length + 1e-6));
        Box jaws;
        for (const Vec3& x : grip.jaw.position) jaws.grow(x);
        CHECK(jaws.size().x() == Approx(length).margin(1e-6));
        // The other end of a box ends jaws too.
        spec.grip[1].from[0] = fmt::format("{}*length", -edge);
        Box other;
        const Machine turned = set_up(spec, body);
        for (const Vec3& x : turned.apparatus.grip[1].jaw.position) other.grow(x);
        CHECK(other.size().x() == Approx(length).margin(1e-6));
    }
}

TEST_CASE("two grips may meet at an edge, and are refused where they hold the same") {
    const Aggregate body = test::make_block(80, 8, 8, 0.0125, Material{});
    MachineSpec spec = vice();
    spec.grip[0].to[0] = spec.grip[1].from[0] = "0.2034*length";
    CHECK(set_up(spec, body).apparatus.grip.size() == 2);
    for (const char* from : {"0.2*length", "0.19*length"}) {
        spec.grip[1].from[0] = from;
        try {
            set_up(spec, body);
            FAIL("it should be refused");
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find("grips hold and turn would hold the same") !=
                  std::string::npos);
        }
    }
}

TEST_CASE("a grip turns its points by the whole angle, also past a full turn") {
    const Aggregate body = bar(0, {4, 4, 4});
    const Machine machine = set_up(vice(), body);
    const Drive end = drive_at(machine, 1, 1);
    const Grip& grip = machine.apparatus.grip[1];
    for (std::size_t n = 0; n < grip.point.size(); ++n) {
        const Vec3 from = body.surface_position(grip.point[n]) - Vec3(4, 4, 4);
        const Vec3 to = end.world_from_grip[1] * grip.anchor[n] - Vec3(4, 4, 4);
        CHECK((to - Vec3(from.x() + 0.1, -from.z(), from.y())).norm() < 1e-12);  // 450 = 90 deg
    }
    CHECK((end.world_from_grip[0].translation -
           drive_at(machine, 0, 1).world_from_grip[0].translation)
              .norm() == 0);
}

TEST_CASE("a grip's box has any two opposite corners") {
    const Aggregate body = bar(0, {1, 1, 1});
    const Machine machine = set_up(vice(), body);
    MachineSpec turned = vice();
    for (GripSpec& grip : turned.grip) {
        std::swap(grip.from[0], grip.to[0]);
        std::swap(grip.from[2], grip.to[2]);
    }
    const Machine same = set_up(turned, body);
    for (std::size_t g = 0; g < machine.apparatus.grip.size(); ++g)
        CHECK(same.apparatus.grip[g].point == machine.apparatus.grip[g].point);
}

TEST_CASE("grips that hold nothing, hold twice or jump at the start are refused by name") {
    MachineSpec spec = vice();
    spec.grip[1].from[0] = "0.6*length";
    CHECK(says(refusal(spec), {"vice", "turn", "holds nothing"}));
    spec = vice();
    spec.grip[1].from[0] = "-0.45*length";
    CHECK(says(refusal(spec), {"vice", "hold", "turn", "same points"}));
    spec = vice();
    spec.grip[1].motion.move[1] = "0.01*height*(1 - t)";
    CHECK(says(refusal(spec), {"vice", "turn", "must be 0 at t = 0"}));
    spec = vice();
    spec.grip[0].motion.turn = "1 deg";
    CHECK(says(refusal(spec), {"vice", "hold", "must be 0 at t = 0"}));
    spec = vice();
    spec.grip[1].motion.turn = "1 deg";  // about the axis that it lies on
    CHECK(says(refusal(spec), {"vice", "turn", "must be 0 at t = 0"}));
}

TEST_CASE("a blade's edge goes where its motion says, its plate behind it") {
    MachineSpec spec;
    spec.name = "guillotine";
    BladeSpec blade;
    blade.name = "blade";
    blade.edge = {{"0.1*length", "height", "-width"}, {"0.1*length", "height", "width"}};
    blade.motion.move = {"0", "-2*height*ramp(t, 0.2, 0.8)", "0"};
    spec.blade = {blade};
    const Aggregate body = bar(0, {1, 1, 1});
    const Machine machine = set_up(spec, body);
    const auto edge_at = [&](double t, int n) -> Vec3 {
        return drive_at(machine, t, 1).world_from_blade[0] * machine.apparatus.blade[0].edge[n];
    };
    CHECK((edge_at(0, 0) - Vec3(1.1, 1.1, 0.9)).norm() < 1e-12);
    CHECK((edge_at(0.2, 1) - Vec3(1.1, 1.1, 1.1)).norm() < 1e-12);
    CHECK((edge_at(0.5, 0) - Vec3(1.1, 1.0, 0.9)).norm() < 1e-12);
    CHECK((edge_at(1, 1) - Vec3(1.1, 0.9, 1.1)).norm() < 1e-12);
    const Box drawn = box_of(machine.apparatus.blade[0].body.position);
    CHECK(drawn.low.y() == Approx(0).margin(1e-12));
    CHECK(drawn.high.y() > 0.2);
    CHECK(drawn.size().x() < 0.05);

    spec.blade[0].edge.pop_back();
    CHECK(says(refusal(spec), {"guillotine", "blade", "edge"}));
    spec.blade[0].edge = {blade.edge[0], blade.edge[1], blade.edge[0]};
    CHECK(says(refusal(spec), {"guillotine", "blade", "begins and ends at one point"}));
    spec.blade = {blade};
    spec.blade[0].thickness = "0";
    CHECK(says(refusal(spec), {"guillotine", "blade", "thickness"}));
    spec.blade[0].thickness = "1e-300";
    CHECK(says(refusal(spec), {"guillotine", "the thickness of blade blade: "}));
}

TEST_CASE("motions and strengths go by the time in the stage, as x = a t^2 / 2") {
    MachineSpec spec = vice();
    spec.grip[1].motion.move = {"0.5*0.04*(t*duration)^2", "0", "0"};
    spec.gravity_strength = "ramp(t*duration, 1, 3)";
    const Aggregate body = bar();
    for (const double duration : {0.5, 4.0}) {
        const Machine machine = build_machine(spec, {}, place_work_frame(body), body, {}, duration);
        const Vec3 from = drive_at(machine, 0, duration).world_from_grip[1].translation;
        for (const double time : {0.1, 0.5}) {
            const Drive now = drive_at(machine, time / duration, duration);
            CHECK((now.world_from_grip[1].translation - from).norm() ==
                  Approx(0.5 * 0.04 * time * time));
        }
        CHECK(drive_at(machine, 1, duration).gravity_strength == (duration > 3 ? 1 : 0));
    }
}

TEST_CASE("the drive's time is the share of the stage's duration") {
    CHECK(drive_at(set_up(vice()), 0.25, 8).time == 2);
}

TEST_CASE("a machine is the same to the bit at any number of threads") {
    const Aggregate body = bar(2, {0.1, 0.2, 0.3});
    set_thread_count(1);
    const Drive one = drive_at(set_up(roller(), body), 0.37, 1);
    set_thread_count(3);
    const Drive three = drive_at(set_up(roller(), body), 0.37, 1);
    set_thread_count(0);
    for (std::size_t n = 0; n < one.world_from_tool.size(); ++n) {
        CHECK(one.world_from_tool[n].translation == three.world_from_tool[n].translation);
        CHECK(one.world_from_tool[n].rotation.coeffs() ==
              three.world_from_tool[n].rotation.coeffs());
    }
}

TEST_CASE("a tool rubs each body by that body's own friction, unless it says another") {
    MachineSpec spec = roller();
    spec.parameter.push_back(
        parameter("rub", Quantity::number, "max(material_friction, 0.2)", "0", "2"));
    ToolSpec third = spec.tool[0];
    third.name = "third";
    third.friction = "rub";
    spec.tool.push_back(third);
    std::vector<Material> beside(2);
    beside[0].friction = 0;
    beside[1].friction = 0.9;
    const Aggregate body = bar();
    const auto on = [&](const std::map<std::string, double>& given, std::size_t tool, int b) {
        return build_machine(spec, given, place_work_frame(body), body, beside)
            .apparatus.tool[tool]
            .friction_on(b);
    };
    CHECK(on({}, 0, 0) == body.material.friction);
    CHECK(on({}, 0, 1) == 0);
    CHECK(on({}, 0, 2) == 0.9);
    for (int b = 0; b < 3; ++b) {
        CHECK(on({}, 1, b) == 0.7);
        CHECK(on({{"rub", 0.4}}, 2, b) == 0.4);
    }
    CHECK(on({}, 2, 0) == body.material.friction);
    CHECK(on({}, 2, 1) == 0.2);
    CHECK(on({}, 2, 2) == 0.9);
}
