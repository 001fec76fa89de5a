// SPDX-License-Identifier: GPL-3.0-or-later
// Where shipped machines stand and what they hold, by their parameters; what these may be.
#include <Eigen/Geometry>
#include <cmath>

#include "machines/parameters.h"
#include "machines/touch.h"
#include "tests/scene/shipped_machines.h"

using namespace swage;
using test::at_bar;
using test::index_of;

namespace {

constexpr double kHalfCell = 0.5 * 0.0125 + 1e-9;  // of the bar, which is 1 m long

Box held_by(const Machine& machine, std::size_t grip, const Aggregate& body) {
    Box held;
    for (const int p : machine.apparatus.grip[grip].point) held.grow(body.surface_position(p));
    return held;
}

Vec3 size_of(const Tool& tool) { return bounds_of(tool.shape).size(); }

std::vector<std::string> all_shipped() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(test::kMachines)) {
        names.push_back(entry.path().stem().string());
    }
    return names;
}

}  // namespace

TEST_CASE("each parameter of a shipped machine alone may be as low and as high as it says") {
    const Aggregate body = bar();
    const WorkFrame frame = place_work_frame(body);
    const Variables known = work_piece_variables(body, frame);
    for (const std::string& name : all_shipped()) {
        const MachineSpec spec = test::shipped_machine(name);
        Variables usual = known;
        for (const auto& [key, value] : resolve_parameters(spec, {}, known)) usual[key] = value;
        for (const ParameterSpec& parameter : spec.parameter) {
            for (const Expression& end : {parameter.low, parameter.high}) {
                const double value = evaluate(end, usual);
                INFO(name << ": " << parameter.name << " = " << value);
                CHECK_NOTHROW(resolve_parameters(spec, {{parameter.name, value}}, known));
            }
        }
    }
}

TEST_CASE("every shipped machine stands at matter of any friction with its defaults") {
    Aggregate body = bar();
    body.material.friction = 2.5;
    for (const std::string& name : all_shipped()) {
        INFO(name);
        CHECK_NOTHROW(at_bar(name, {}, body));
    }
}

TEST_CASE("the floor slopes down along the work-piece, and lies as far below it as it is told") {
    const double slope = 20 * kPi / 180, drop = 0.03;
    for (const int axis : {0, 2}) {
        const Aggregate body = bar(axis);
        const WorkFrame frame =
            place_work_frame(body, axis == 0 ? WorldAxis::x : WorldAxis::z, WorldAxis::y);
        const Machine machine = build_machine(test::shipped_machine("floor"),
                                              {{"slope", slope}, {"drop", drop}}, frame, body);
        const Pose pose = drive_at(machine, 0, 1).world_from_tool[0];
        Vec3 normal(0, std::cos(slope), 0);
        normal[axis] = std::sin(slope);
        INFO("along " << axis);
        CHECK((pose.rotation * Vec3::UnitZ() - normal).norm() < 1e-9);
        const Tool& floor = machine.apparatus.tool[0];
        CHECK(nearest_distance(floor.shape, pose, surface_positions(body)) ==
              Approx(drop).margin(1e-8));
        CHECK(normal.dot(pose.translation) < 0);  // not above it
    }
}

TEST_CASE("the vice clamps the end it is told, as far as it is told") {
    const Aggregate body = bar();
    for (const int side : {-1, 1}) {
        const Machine machine = at_bar("hold", {{"side", side}, {"grip_length", 0.3}}, body);
        REQUIRE(machine.apparatus.grip.size() == 1);
        const Box held = held_by(machine, 0, body);
        const double inner = side < 0 ? -held.high.x() : held.low.x(),
                     outer = side < 0 ? -held.low.x() : held.high.x();
        CHECK(std::abs(inner - 0.2) <= kHalfCell);
        CHECK(outer == Approx(0.5));
    }
}

TEST_CASE("the press's plate is as long as it is told, and stands where it is told") {
    const Machine machine = at_bar("press", {{"place", 0.2}, {"plate_length", 0.4}});
    const int plate = index_of(machine.apparatus.tool, "plate");
    CHECK(drive_at(machine, 0, 1).world_from_tool[plate].translation.x() == Approx(0.2));
    CHECK(size_of(machine.apparatus.tool[plate]).x() == Approx(0.4));
}

TEST_CASE("the shelf's supports are its span apart, on both sides of the middle") {
    const Machine machine = at_bar("shelf", {{"span", 0.5}});
    for (const int side : {-1, 1}) {
        const int tool = index_of(machine.apparatus.tool, side < 0 ? "left" : "right");
        CHECK(drive_at(machine, 0, 1).world_from_tool[tool].translation.x() == Approx(0.25 * side));
    }
}

TEST_CASE("the stretcher's grips hold as much of the ends as they are told") {
    const Aggregate body = bar();
    const Machine machine = at_bar("stretch", {{"grip_length", 0.3}}, body);
    const Box hold = held_by(machine, 0, body), draw = held_by(machine, 1, body);
    CHECK(std::abs(hold.high.x() + 0.2) <= kHalfCell);
    CHECK(std::abs(draw.low.x() - 0.2) <= kHalfCell);
    CHECK(hold.low.x() == Approx(-0.5));
    CHECK(draw.high.x() == Approx(0.5));
}

TEST_CASE("the twister stretches as it turns, and then does neither") {
    const double angle = 1.2;
    const Machine machine = at_bar("twist", {{"angle", angle}, {"stretch", 0.2}, {"turning", 0.5}});
    const Pose start = drive_at(machine, 0, 1).world_from_grip[1];
    for (const double t : {0.25, 0.5, 1.0}) {
        const double share = std::min(2 * t, 1.0);
        const Pose now = drive_at(machine, t, 1).world_from_grip[1];
        INFO(t);
        CHECK((now.translation - start.translation - Vec3(0.2 * share, 0, 0)).norm() < 1e-9);
        CHECK((turn_between(start, now) - Vec3(angle * share, 0, 0)).norm() < 1e-9);
    }
}

TEST_CASE("the slicer holds the part of each slice that it is told, in its middle") {
    const Aggregate body = bar();
    const Machine machine = at_bar("slice", {{"slices", 4}, {"held", 0.2}}, body);
    REQUIRE(machine.apparatus.grip.size() == 4);
    for (std::size_t n = 0; n < 4; ++n) {
        const Box held = held_by(machine, n, body);
        const double middle = (static_cast<double>(n) - 1.5) / 4;
        CHECK(std::abs(held.low.x() - (middle - 0.025)) <= kHalfCell);
        CHECK(std::abs(held.high.x() - (middle + 0.025)) <= kHalfCell);
    }
}

TEST_CASE("the wringer's jaws are as long as they are told, from the ends inwards") {
    const Machine machine = at_bar("wring", {{"jaw_length", 0.3}});
    const Drive start = drive_at(machine, 0, 1);
    REQUIRE(machine.apparatus.tool.size() == 8);
    for (std::size_t n = 0; n < 8; ++n) {
        const Tool& jaw = machine.apparatus.tool[n];
        INFO(jaw.name);
        const double side = jaw.name.find("hold") == 0 ? -1 : 1;
        CHECK(size_of(jaw).x() == Approx(0.3));
        CHECK(start.world_from_tool[n].translation.x() == Approx(0.35 * side));
    }
}
