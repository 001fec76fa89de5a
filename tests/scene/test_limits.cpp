// SPDX-License-Identifier: GPL-3.0-or-later
// [[stage.limit]], and the variable that machines stop by.
#include "scene/read_machine.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

Parts limit(const std::string& lines, const std::string& machine = "bend",
            const std::string& more = "") {
    return with(&Parts::stage,
                "[[stage]]\nmachine = \"" + machine + "\"\n" + more + "[[stage.limit]]\n" + lines);
}

}  // namespace

TEST_CASE("limits are read with part and amount, of force or torque") {
    const SceneFolder scratch;
    Parts parts = limit(
        "part = \"left\"\nforce = \"2 kN\"\n[[stage.limit]]\npart = \"right\"\n"
        "torque = \"500 N m\"\n");
    const SceneReading reading = read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    const std::vector<LimitSpec>& limits = reading.scene->stage[0].machine.limit;
    REQUIRE(limits.size() == 2);
    CHECK(limits[0].part == "left");
    CHECK(limits[0].most == 2000);
    CHECK_FALSE(limits[0].of_torque);
    CHECK(limits[1].part == "right");
    CHECK(limits[1].most == 500);
    CHECK(limits[1].of_torque);
}

TEST_CASE("mistakes in limits are found at their place") {
    check_all({
        {"of no part", limit("force = \"2 kN\"\n"), {"9:1: [[stage.limit]] needs \"part\": "}},
        {"of an unknown part",
         limit("part = \"lefd\"\nforce = \"2 kN\"\n"),
         {"10:8: machine bend has no tool or grip \"lefd\", did you mean \"left\"? It has "
          "support, left, right"}},
        {"of both",
         limit("part = \"left\"\nforce = \"2 kN\"\ntorque = \"2 N m\"\n"),
         {"12:10: a limit is a force or a torque: give one of them"}},
        {"of neither", limit("part = \"left\"\n"), {"9:1: [[stage.limit]] needs \"force\": "}},
        {"negative",
         limit("part = \"left\"\nforce = \"-2 kN\"\n"),
         {"11:9: force = -2 kN is out of range: it must be more than 0 N"}},
        {"of nothing",
         limit("part = \"left\"\ntorque = 0\n"),
         {"11:10: torque = 0 N m is out of range: it must be more than 0 N m"}},
        {"of another unit",
         limit("part = \"left\"\nforce = \"2 N m\"\n"),
         {"11:12: force: \"2 N m\" is a torque; expected a force"}},
        {"torque of what does not turn",
         limit("part = \"support\"\ntorque = \"2 N m\"\n"),
         {"11:10: support does not rotate, so its torque has no axis: limit its force, or the "
          "torque of left, right"}},
        {"torque where nothing turns",
         limit("part = \"plate\"\ntorque = \"2 N m\"\n", "press"),
         {"11:10: plate does not rotate, so its torque has no axis: no part of this machine does; "
          "limit a force"}},
        {"of a machine that cannot stop",
         limit("part = \"vice\"\nforce = \"2 N\"\n", "hold", "gravity = \"9.81 m/s2\"\n"),
         {"10:1: no motion of machine hold can stop early: one that can uses the variable stop"}},
        {"in motion",
         limit("part = \"left\"\nforce = \"2 N\"\n", "bend", "solver = \"explicit\"\n"),
         {"10:1: a limit needs equilibria: with solver = \"explicit\" forces oscillate, and no "
          "machine can stop at one; choose solver = \"quasistatic\""}},
        {"with an unknown key",
         limit("part = \"left\"\nforce = \"2 N\"\naxis = \"x\"\n"),
         {"12:1: unknown key \"axis\" in [[stage.limit]]"}},
    });
}

TEST_CASE("a limit on a blade, of a machine that cannot stop, is one mistake") {
    const std::string told =
        mistakes_in(limit("part = \"blade\"\nforce = \"2 N\"\n", "cut").text());
    INFO(told);
    CHECK(told.find("no motion of machine cut can stop early") != std::string::npos);
    CHECK(std::count(told.begin(), told.end(), '\n') == 1);
}

TEST_CASE("a load that goes by stop can be halted by a limit, on a machine that cannot itself") {
    const std::string load =
        "[[stage.load]]\nforce = [0, \"-2 N\", 0]\nstrength = \"ramp(min(t, stop), 0, 1)\"\n";
    CHECK(mistakes_in(limit("part = \"vice\"\nforce = \"1 N\"\n" + load, "hold").text()) == "");
}

TEST_CASE("no blade stops, and no parameter is called stop") {
    const SceneFolder scratch;
    const auto mistakes = [&](const std::string& text) {
        return told(read_machine(scratch.write("m.toml", text)).mistakes, scratch.path());
    };
    const std::string blade = "[[blade]]\nname = \"b\"\nedge = [[0, 0, 0], [0, 0, 1]]\n";
    CHECK(mistakes(blade + "[blade.motion]\nmove = [\"-min(t, stop)\", 0, 0]\n")
              .find("m.toml:5:18: move: unknown name \"stop\"") != std::string::npos);
    CHECK(mistakes("[parameter.stop]\nquantity = \"number\"\ndefault = 1\n" + blade)
              .find("the parameter's name \"stop\" is the time at which a limit is reached") !=
          std::string::npos);
}
