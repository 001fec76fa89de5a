// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_machine.h"

#include "tests/catch.h"
#include "tests/scene/scene_folder.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("a lone gravity points against what the machine calls up, however the body stands") {
    const test::SceneFolder scratch;
    const std::string stage = GENERATE("", "up = \"z\"\n", "up = \"-x\"\n", "axis = \"z\"\n");
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = "
                                 "\"rubber\"\n[[stage]]\nmachine = \"shelf\"\n"
                                 "gravity = \"9.81 m/s2\"\n" +
                                     stage),
                   {}, test::shipped());
    REQUIRE(reading.scene);
    const StageSpec& shelf = reading.scene->stage[0];
    for (int longest = 0; longest < 3; ++longest) {
        INFO(stage << longest);
        Vec3i cells(4, 4, 4);
        cells[longest] = 16;
        const Aggregate body = test::make_block(cells.x(), cells.y(), cells.z(), 0.1,
                                                reading.scene->work_piece().material);
        const Machine machine = stage_machine(shelf, body, {}, Box{});
        const Vec3 up = machine.frame.world_from_work.turn(Vec3::UnitY());
        CHECK((shelf.sim.gravity + 9.81 * up).norm() < 1e-12);
        for (const Pose& rest : machine.work_from_tool) {
            CHECK((machine.frame.world_from_work * rest.translation).dot(up) < -0.2);
        }
    }
}

namespace {

// Of the first mistake that setting up and going its way finds, on a bar of matter.
std::string told_of_stage(const test::SceneFolder& scratch, const std::string& stage) {
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                 "[[stage]]\n" +
                                     stage),
                   {}, test::shipped());
    INFO(test::told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    const StageSpec& spec = reading.scene->stage[0];
    const Aggregate body = test::make_block(16, 4, 4, 0.1, reading.scene->work_piece().material);
    try {
        stage_legs(spec, stage_machine(spec, body, {}, Box{}), 4, body.lattice.spacing);
    } catch (const SceneError& error) {
        CHECK(error.code() == ExitCode::scene);
        return test::told({error.mistakes()[0]}, scratch.path());
    }
    return "nothing";
}

}  // namespace

TEST_CASE("an expression that has no value, or none that can be meant, is told at its place") {
    struct Case {
        const char *motion, *stage, *told;
    };
    const Case cases[] = {
        {"",
         "machine = \"shelf\"\n[[stage.load]]\npressure = 1\nname = \"wind\"\n"
         "strength = \"1/(t - 0.5)\"\n",
         "s.toml:10:12: machine shelf: the strength of load wind at t = 0.5: in \"1/(t - 0.5)\": "
         "the expression does not give a finite number (stage \"1-shelf\")\n"},
        {"", "machine = \"shelf\"\ngravity = 9.81\ngravity_strength = \"log(t)\"\n",
         "s.toml:8:20: machine shelf: gravity_strength at t = 0: in "},
        {"move = [\"t < 0.5 ? 0 : log(t - 1)\", 0, 0]", "machine = \"slide\"\n",
         "machines/slide.toml:6:9: machine slide: the motion of grip jaw at t = "},
        {"turn = \"1e300*t\"", "machine = \"slide\"\n",
         "machines/slide.toml:6:8: machine slide: the motion of grip jaw at t = "},
        {"move = [0, \"length/0\", 0]", "machine = \"slide\"\n",
         "machines/slide.toml:6:12: machine slide: in \"length/0\": the expression does not give a "
         "finite number (stage \"1-slide\")\n"},
        {"move = [1, 0, 0]", "machine = \"slide\"\n",
         "machines/slide.toml:6:9: machine slide: the motion of grip jaw must be 0 at t = 0"},
    };
    const test::SceneFolder scratch;
    for (const Case& one : cases) {
        scratch.write("machines/slide.toml",
                      "[[grip]]\nname = \"jaw\"\nfrom = [-9, -9, -9]\nto = [9, 9, 9]\n"
                      "[grip.motion]\n" +
                          std::string(one.motion) + "\n");
        const std::string told = told_of_stage(scratch, one.stage);
        INFO(one.motion << one.stage << told);
        CHECK(told.find(one.told) == 0);
    }
}

TEST_CASE("what a part of a machine cannot do at the work-piece is told where its file has it") {
    const test::SceneFolder scratch;
    const auto told = [&](const std::string& part) {
        scratch.write("machines/odd.toml", part);
        return told_of_stage(scratch, "machine = \"odd\"\n");
    };
    const std::string ball = "[[tool]]\nname = \"ball\"\nshape = \"sphere\"\n";
    CHECK(told("[[grip]]\nname = \"a\"\nfrom = [5, 5, 5]\nto = [6, 6, 6]\n")
              .find("machines/odd.toml:3:9: machine odd: grip a holds nothing") == 0);
    CHECK(told(ball + "radius = 0.01\nat = [100, 0, 0]\ntouch = [0, -1, 0]\n")
              .find("machines/odd.toml:6:10: machine odd: tool ball can never touch") == 0);
    CHECK(told(ball + "radius = \"1e20*length\"\nat = [0, 0, 0]\n")
              .find("machines/odd.toml:4:10: machine odd: the radius of tool ball: ") == 0);
    CHECK(told(ball + "radius = \"length - 1.6\"\nat = [0, 0, 0]\n")
              .find("machines/odd.toml:4:10: machine odd: the radius of tool ball") == 0);
}

TEST_CASE("a default out of its range is told where it stands, a given value where it is given") {
    const test::SceneFolder scratch;
    scratch.write("machines/ball.toml",
                  "[parameter.size]\nquantity = \"length\"\ndefault = \"2 m\"\nlow = 0\n"
                  "high = \"height\"\n[[tool]]\nname = \"ball\"\nshape = \"sphere\"\n"
                  "radius = \"size\"\nat = [0, 9, 0]\n");
    CHECK(told_of_stage(scratch, "machine = \"ball\"\n")
              .find("machines/ball.toml:3:11: machine ball: the default of size = 2 m is out of "
                    "range: it must be 0 m to 40 cm (stage \"1-ball\")") == 0);
    CHECK(told_of_stage(scratch, "machine = \"ball\"\nsize = \"3 m\"\n")
              .find("s.toml:7:8: machine ball: size = 3 m is out of range") == 0);
}

TEST_CASE("a blade that never moves is warned of by name, one that goes or falls is not") {
    const test::SceneFolder scratch;
    const auto told = [&](const std::string& motion, const std::string& keys) {
        scratch.write("machines/saw.toml",
                      "[[blade]]\nname = \"tooth\"\nedge = [[0, 1, -1], [0, 1, 1]]\n" + motion);
        const SceneReading reading =
            read_scene(scratch.write("s.toml",
                                     "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                     "[[stage]]\nmachine = \"saw\"\n" +
                                         keys),
                       {}, test::shipped());
        return test::told(reading.mistakes, scratch.path());
    };
    CHECK(told("", "").find("nothing happens: blade tooth never moves") != std::string::npos);
    CHECK(told("[blade.motion]\nmove = [0, \"-t\", 0]\n", "").empty());
    CHECK(told("", "gravity = 9.81\n").find("never moves") == std::string::npos);
}

TEST_CASE(
    "a later machine that cannot stand at the work-piece as it is at first is told of before") {
    const test::SceneFolder scratch;
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                 "[[stage]]\nmachine = \"press\"\n"
                                 "[[stage]]\nmachine = \"press\"\nup = \"x\"\n"),
                   {}, test::shipped());
    REQUIRE(reading.scene);
    const Material& rubber = reading.scene->work_piece().material;
    const std::vector<std::string> told =
        foreseen_mistakes(*reading.scene, test::make_block(16, 4, 4, 0.1, rubber), Box{}, {});
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("s.toml:") != std::string::npos);
    CHECK(told[0].find("up = \"x\"") != std::string::npos);
    CHECK(foreseen_mistakes(*reading.scene, test::make_block(4, 4, 16, 0.1, rubber), Box{}, {})
              .empty());
}
