// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/bend_watch.h"

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

ToolSpec tool(const char* name, const char* x, const char* y, const char* turn) {
    ToolSpec tool;
    tool.name = name;
    tool.shape = ToolShape::cylinder;
    tool.radius = "0.05", tool.length = "0.4";
    tool.at = {x, y, "0"};
    tool.motion.turn = turn;
    tool.motion.pivot = {"0", "-0.3", "0"};
    return tool;
}

// Two tools over a bar that go round what is below it by 45 degrees each, and back.
struct Bender {
    Aggregate bar = test::make_block(20, 2, 2, 0.1, Material{});
    const Aggregate before = bar;
    Machine machine;

    explicit Bender(const char* right = "-pi/4*(1 - abs(2*t - 1))", bool parted = false) {
        if (parted) test::sever_plane(bar, Vec3(0.0501, 0, 0), Vec3::UnitX());
        MachineSpec spec;
        spec.name = "bender";
        spec.tool = {tool("left", "-0.6", "0.2", "pi/4*(1 - abs(2*t - 1))"),
                     tool("right", "0.6", "0.2", right)};
        machine = build_machine(spec, {}, place_work_frame(bar), bar);
    }

    // Each end turned about the middle, the left one as drawn, in degrees.
    void turn_ends(double left, double right) {
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            const Vec3 at = before.particle_position.at(p);
            const double angle = (at.x() < 0 ? left : right) * kPi / 180;
            bar.particle_position.set(p, turn_about(Vec3::UnitZ(), angle) * at);
        }
    }
};

Json record_of(const BendWatch& watch, const Bender& on) {
    Json json = Json::object();
    watch.add_to(json, on.bar);
    json["name"] = "bend";
    return json;
}

}  // namespace

TEST_CASE("a bend is told as its ends turned, held and sprung back, however the body turns whole") {
    for (const double whole : {0.0, 25.0}) {
        Bender bender;
        BendWatch watch(bender.machine, drive_at(bender.machine, 0, 1), bender.bar);
        bender.turn_ends(44 + whole, -44 + whole);
        watch.look(7, drive_at(bender.machine, 0.5, 1), bender.bar);
        bender.turn_ends(40 + whole, -40 + whole);
        watch.look(9, drive_at(bender.machine, 1, 1), bender.bar);
        const Json bend = record_of(watch, bender).at("bend");
        CHECK(bend.at("tools_deg").get<double>() == Approx(90).epsilon(1e-9));
        CHECK(bend.at("most_deg").get<double>() == Approx(88).epsilon(1e-9));
        CHECK(bend.at("most_in_frame") == 7);
        CHECK(bend.at("at_end_deg").get<double>() == Approx(80).epsilon(1e-9));
        CHECK(watch.warning(bender.bar).empty());
        CHECK(bend_text(record_of(watch, bender)) ==
              "bend: its ends turned by 88 deg under tools that turned by 90 deg (frame 7), and "
              "stand at 80 deg as it ends");
    }
}

TEST_CASE("a body that only turns between tools that bend is told not to be bent") {
    Bender bender;
    BendWatch watch(bender.machine, drive_at(bender.machine, 0, 1), bender.bar);
    bender.turn_ends(45, 43);
    watch.look(7, drive_at(bender.machine, 0.5, 1), bender.bar);
    CHECK(watch.warning(bender.bar) ==
          "the tools turned by 90 deg against each other, the work-piece's ends by 2 deg at the "
          "most: it slipped, rolled or tilted between them, and is hardly bent");
}

TEST_CASE("pieces that nothing joins are not bent") {
    Bender bender("-pi/4*(1 - abs(2*t - 1))", true);
    BendWatch watch(bender.machine, drive_at(bender.machine, 0, 1), bender.bar);
    bender.turn_ends(45, -45);
    watch.look(7, drive_at(bender.machine, 0.5, 1), bender.bar);
    CHECK(watch.warning(bender.bar).find("no matter joins the work-piece's ends") == 0);
    CHECK(bend_text(record_of(watch, bender)).empty());
}

TEST_CASE("tools that turn together, or in their places, bend nothing that is told") {
    Bender together("pi/4*(1 - abs(2*t - 1))");
    Bender rollers;
    MachineSpec spec = rollers.machine.spec;
    for (ToolSpec& tool : spec.tool) {
        const std::string x = tool.name == "left" ? "-0.6" : "0.6";
        tool.motion.pivot = {x, "0.2", "0"};
    }
    rollers.machine = build_machine(spec, {}, place_work_frame(rollers.bar), rollers.bar);
    for (Bender* one : {&together, &rollers}) {
        BendWatch watch(one->machine, drive_at(one->machine, 0, 1), one->bar);
        one->turn_ends(10, -10);
        watch.look(7, drive_at(one->machine, 0.5, 1), one->bar);
        CHECK(watch.warning(one->bar).empty());
        CHECK_FALSE(record_of(watch, *one).contains("bend"));
    }
}
