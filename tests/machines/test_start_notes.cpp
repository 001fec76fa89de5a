// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"

#include <filesystem>
#include <utility>

#include "geometry/mesh_write.h"

#include "tests/catch.h"
#include "tests/machines/bodies.h"
#include "tests/shared/block.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

// 1 m long, 0.2 m high and wide, of cells of 2.5 cm.
Aggregate beam() { return test::make_block(40, 8, 8, 0.025, Material{}); }

std::vector<std::string> notes_of(const MachineSpec& spec, const Aggregate& body = beam()) {
    return build_machine(spec, {}, place_work_frame(body), body).notes;
}

MachineSpec with(const ToolSpec& tool) {
    MachineSpec spec;
    spec.name = "bench";
    spec.tool = {tool};
    return spec;
}

// Lies under the work-piece.
ToolSpec roll() {
    ToolSpec tool;
    tool.name = "roll";
    tool.shape = ToolShape::cylinder;
    tool.radius = "height";
    tool.length = "2*width";
    tool.at = {"0", "-2*height", "0"};
    tool.touch = {"0", "1", "0"};
    return tool;
}

bool tells(const std::vector<std::string>& notes, const std::string& words) {
    return notes.size() == 1 && notes[0].find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a tool that turns about the work-piece's middle unasked is noted, with its own") {
    ToolSpec tool = roll();
    tool.motion.turn = "3*t";
    const std::vector<std::string> notes = notes_of(with(tool));
    CHECK(tells(notes, "tool roll turns about the middle of the work-piece, "));
    CHECK(tells(notes, "pivot = [\"roll_x\", \"roll_y\", \"roll_z\"]"));

    ToolSpec asked = tool;
    asked.motion.pivot = {"0", "0", "0"};
    CHECK(notes_of(with(asked)).empty());
    ToolSpec about_its_middle = tool;
    about_its_middle.motion.axis = {"0", "1", "0"};
    CHECK(notes_of(with(about_its_middle)).empty());
    ToolSpec by_nothing = tool;
    by_nothing.motion.turn = "0*t";
    CHECK(notes_of(with(by_nothing)).empty());
}

TEST_CASE("a motion without a pivot turns about the middle of the work-piece's box") {
    ToolSpec tool = roll();
    tool.motion.turn = "pi*t";
    const Aggregate body = beam();
    const Machine machine = build_machine(with(tool), {}, place_work_frame(body), body);
    const Vec3 start = drive_at(machine, 0, 1).world_from_tool[0].translation;
    CHECK((drive_at(machine, 1, 1).world_from_tool[0].translation + start).norm() < 1e-9);
}

TEST_CASE("a tool wholly inside the work-piece is noted, one that only touches is not") {
    ToolSpec core = roll();
    core.shape = ToolShape::box;
    core.size = {"0.2*length", "0.5*height", "0.5*width"};
    core.at = {"0", "0", "0"};
    core.touch = {"0", "0", "0"};
    CHECK(tells(notes_of(with(core)),
                "tool roll starts entirely inside the work-piece, where it meets no surface and "
                "pushes nothing"));
    core.at = {"0", "0.4*height", "0"};
    CHECK(tells(notes_of(with(core)), "deep in the work-piece"));
    core.at = {"0", "0.76*height", "0"};
    CHECK(notes_of(with(core)).empty());
    core.touch = {"0", "-1", "0"};
    CHECK(notes_of(with(core)).empty());
}

TEST_CASE(
    "a tool that its motion starts deep in the work-piece is noted, one that starts off it "
    "or squeezes as its gap says is not") {
    ToolSpec tool = roll();
    tool.motion.move = {"0", "0.3*height + 0.1*height*t", "0"};
    CHECK(tells(notes_of(with(tool)), "deep in the work-piece: its motion is not 0 at t = 0"));
    tool.motion.move = {"0", "-0.3*height + 0.1*height*t", "0"};
    CHECK(notes_of(with(tool)).empty());
    tool.gap = "-0.3*spacing";
    tool.motion.move = {"0", "0.1*height*t", "0"};
    CHECK(notes_of(with(tool)).empty());
}

TEST_CASE("what jumps is noted with the time, what goes fast is not") {
    ToolSpec tool = roll();
    tool.motion.move = {"0", "height*step(t, 0.37)", "0"};
    CHECK(tells(notes_of(with(tool)), "tool roll jumps by up to 20 cm at t = 0.37"));
    tool.motion.move = {"0", "-height*line(t, 0.5, 0.5)", "0"};
    CHECK(tells(notes_of(with(tool)), "at t = 0.5"));
    tool.motion.move = {"0", "height*ramp(t, 0.5, 0.501)", "0"};
    CHECK(notes_of(with(tool)).empty());
    tool.motion.move = {"0", "0", "0"};
    tool.motion.pivot = {"roll_x", "roll_y", "0"};
    tool.motion.turn = "step(t, 0.25)";
    CHECK(tells(notes_of(with(tool)), "at t = 0.25"));

    MachineSpec vice;
    vice.name = "vice";
    vice.grip = vice_grips();
    vice.grip[1].motion.move[0] = "0.1*length*step(t, 0.75)";
    CHECK(tells(notes_of(vice), "grip turn jumps by up to 10 cm at t = 0.75"));
}

TEST_CASE("a blade that passes beside the work-piece all its way is noted, one that meets it not") {
    BladeSpec blade;
    blade.name = "knife";
    blade.edge = {{"0", "3*height", "-width"}, {"0", "3*height", "width"}};
    MachineSpec spec;
    spec.name = "cutter";
    const auto notes = [&](const Expression3& move) {
        blade.motion.move = move;
        spec.blade = {blade};
        return notes_of(spec);
    };
    CHECK(tells(notes({"0", "-1.5*height*t", "0"}),
                "blade knife misses the work-piece where that is now, by at least"));
    CHECK(tells(notes({"0", "-1.5*height*t", "0"}), "by at least 20 cm"));
    CHECK(tells(notes({"2*length*t", "0", "0"}),
                "blade knife misses the work-piece where that is now, by at least"));
    CHECK(notes({"0", "-4*height*t", "0"}).empty());
    CHECK(notes({"0", "-10*height*sin(pi*t)", "0"}).empty());
    CHECK(notes({"0", "-2.5*height*t", "0"}).empty());
    ToolSpec lift = roll();
    lift.motion.move = {"0", "height*t", "0"};
    spec.tool = {lift};
    CHECK(notes({"0", "-1.5*height*t", "0"}).empty());
    // One that stands cuts nothing, whatever is brought to it.
    for (const char* still : {"0", "0*height*t"}) {
        CHECK(tells(notes({"0", still, "0"}),
                    "blade knife stands still: blades cut only by their own motion"));
    }
}

namespace {

ToolSpec box_tool(const char* name, const Expression3& size, const Expression3& at,
                  const Expression3& move = {"0", "0", "0"}) {
    ToolSpec tool;
    tool.name = name;
    tool.shape = ToolShape::box;
    tool.size = size;
    tool.rounding = "0.01*height";
    tool.at = at;
    tool.motion.move = move;
    return tool;
}

// A block stands beside the way of a punch that comes down above the work-piece; both as far from
// it as their motions need. Spacing: height/8.
MachineSpec punch_and(const ToolSpec& beside, const char* down) {
    MachineSpec spec;
    spec.name = "press";
    spec.tool = {box_tool("punch", {"height", "height", "height"}, {"0", "10*height", "0"},
                          {"0", down, "0"}),
                 beside};
    return spec;
}

}  // namespace

TEST_CASE("tools that pass into each other are noted with depth and time, those that meet not") {
    const ToolSpec below =
        box_tool("die", {"2*height", "height", "2*height"}, {"0.1*height", "7*height", "0"});
    CHECK(notes_of(punch_and(below, "-2*height*t")).empty());  // flush at the end
    CHECK(notes_of(punch_and(below, "-1.5*height*sin(pi*t)")).empty());
    const char* deeper = "-2.1*height*ramp(t, 0, 0.5) + 3*height*ramp(t, 0.5, 1)";
    const std::vector<std::string> notes = notes_of(punch_and(below, deeper));
    CHECK(tells(notes, "tools punch and die overlap by 2 cm at t = 0.5"));

    // Crossed bars have no corner in each other.
    const ToolSpec across =
        box_tool("bar", {"0.2*height", "0.2*height", "9*height"}, {"0", "7*height", "0"});
    CHECK(tells(notes_of(punch_and(across, "-2.5*height*t")), "tools punch and bar overlap by"));
    const ToolSpec past =
        box_tool("bar", {"0.2*height", "9*height", "9*height"}, {"0.61*height", "7*height", "0"});
    CHECK(notes_of(punch_and(past, "-2.5*height*t")).empty());
}

TEST_CASE("a machine built of boxes that stand in each other is noted only where they go deeper") {
    const Expression3 size = {"3*height", "height", "3*height"}, at = {"0", "9.4*height", "0"};
    const char* down = "-2*height*t";
    CHECK(notes_of(punch_and(box_tool("arm", size, at), "0")).empty());
    CHECK(notes_of(punch_and(box_tool("arm", size, at, {"0", down, "0"}), down)).empty());
    CHECK(notes_of(punch_and(box_tool("arm", size, at), "2*height*t")).empty());
    CHECK(tells(notes_of(punch_and(box_tool("arm", size, at), "-0.2*height*t")),
                " of it from the start"));
}

TEST_CASE("a punch that ends below the rim of a ring is noted, one that goes down its bore not") {
    const Scratch folder;
    const std::filesystem::path file = folder.path() / "ring.obj";
    write_obj(file, test::torus_mesh(0.4, 0.1, 96, 48));
    ToolSpec ring = box_tool("ring", {"0", "0", "0"}, {"0", "5*height", "0"});
    ring.shape = ToolShape::mesh;
    ring.mesh = file;
    ring.length = "5*height";  // 1 m: as it is
    ring.axis = {"0", "1", "0"};
    ToolSpec punch = box_tool("punch", {"0", "0", "0"}, {"0", "10*height", "0"});
    punch.shape = ToolShape::cylinder;
    punch.axis = {"0", "1", "0"};
    punch.length = "height";
    MachineSpec spec;
    spec.name = "draw";
    // Its low end comes to 1.2 cm below the ring's top, which is at 5.5 heights.
    punch.motion.move = {"0", "-4.06*height*t", "0"};
    for (const auto& [radius, is_caught] : {std::pair("0.29", false), std::pair("0.45", true)}) {
        punch.radius = radius;
        spec.tool = {ring, punch};
        const std::vector<std::string> notes = notes_of(spec);
        CHECK(notes.empty() != is_caught);
        if (is_caught) CHECK(tells(notes, "tools ring and punch overlap by 1.2 cm at t ="));
    }
}

TEST_CASE("a load on nothing but what grips clamp is noted, and one on more is not") {
    const auto notes = [](Side on, std::array<bool, 3> along = {true, true, true}) {
        MachineSpec spec;
        spec.name = "vice";
        spec.grip = {vice_grips()[0]};
        spec.grip[0].along = along;
        LoadSpec load;
        load.name = "wind";
        load.on = on;
        load.force = Expression3{"0", "-1 N", "0"};
        spec.load = {load};
        return notes_of(spec);
    };
    CHECK(tells(notes(Side::left), "load wind does nothing: all that it acts on is clamped"));
    CHECK(notes(Side::right).empty());
    CHECK(notes(Side::top).empty());
    CHECK(notes(Side::left, {true, false, true}).empty());
}

TEST_CASE("a narrow load beside a grip is not said to do nothing, one on what is all held is") {
    const auto notes = [](const char* from, const char* to) {
        MachineSpec spec;
        spec.name = "vice";
        spec.grip = {vice_grips()[0]};
        spec.grip[0].to[0] = "-0.399*length";  // over 0.08 of a row of patches
        LoadSpec load;
        load.name = "wind";
        load.on = Side::top;
        load.force = Expression3{"0", "-1 N", "0"};
        load.box = {{{from, "0", "-width"}, {to, "height", "width"}}};
        spec.load = {load};
        return notes_of(spec);
    };
    CHECK(notes("-0.398*length", "-0.39*length").empty());
    CHECK(tells(notes("-0.48*length", "-0.402*length"), "load wind does nothing"));
}

TEST_CASE("loads that come to nothing at this work-piece are noted, and those that act are not") {
    const auto notes = [](const Expression3& force, const char* strength,
                          const char* gravity = "") {
        MachineSpec spec;
        spec.name = "vice";
        spec.grip = {vice_grips()[0]};
        LoadSpec load;
        load.name = "wind";
        load.on = Side::top;
        load.force = force;
        load.strength = strength;
        spec.load = {load};
        if (*gravity != 0) spec.gravity_strength = gravity;
        return notes_of(spec);
    };
    const Expression3 push = {"0", "-1 N", "0"};
    CHECK(tells(notes({"0", "0*height", "0"}, "t"),
                "load wind does nothing: its force is 0 at this work-piece"));
    CHECK(tells(notes(push, "t*(height > length)"),
                "load wind does nothing: its strength is 0 throughout at this work-piece"));
    CHECK(tells(notes(push, "t", "max(0, height - length)"),
                "gravity does nothing: its strength is 0 throughout at this work-piece"));
    CHECK(notes({"0", "0*height", "1 N"}, "t").empty());
    CHECK(notes(push, "t*(height < length)").empty());
    CHECK(notes(push, "t", "1*height").empty());
    // A scene's text tells these by itself.
    CHECK(notes({"0", "0", "0"}, "t").empty());
    CHECK(notes(push, "0*t").empty());

    MachineSpec spec;
    spec.name = "vice";
    spec.grip = {vice_grips()[0]};
    spec.load.resize(1);
    spec.load[0].name = "wind";
    spec.load[0].pressure = "5*(height > length)";
    CHECK(tells(notes_of(spec), "load wind does nothing: its pressure is 0 at this work-piece"));
}
