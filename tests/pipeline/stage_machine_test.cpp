// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_machine.h"

#include "tests/catch.h"
#include "tests/scene/scratch.h"
#include "tests/shared/block.h"

using namespace swage;

TEST_CASE("a lone gravity points against what the machine calls up, however the body stands") {
    const test::Scratch scratch;
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
        const Machine machine = stage_machine(shelf, body, {});
        const Vec3 up = machine.frame.world_from_work.turn(Vec3::UnitY());
        CHECK((shelf.sim.gravity + 9.81 * up).norm() < 1e-12);
        for (const Pose& rest : machine.work_from_tool) {
            CHECK((machine.frame.world_from_work * rest.translation).dot(up) < -0.2);
        }
    }
}

TEST_CASE("an expression that has no value at some time is told at its stage, with its part") {
    const test::Scratch scratch;
    scratch.write("machines/slide.toml",
                  "[[grip]]\nname = \"jaw\"\nfrom = [-9, -9, -9]\nto = [9, 9, 9]\n"
                  "[grip.motion]\nmove = [\"t < 0.5 ? 0 : log(t - 1)\", 0, 0]\n");
    const auto [stage, part] =
        GENERATE(std::pair("machine = \"shelf\"\n[[stage.load]]\npressure = 1\nname = \"wind\"\n"
                           "strength = \"1/(t - 0.5)\"\n",
                           "the strength of load wind at t = 0.5"),
                 std::pair("machine = \"shelf\"\ngravity = 9.81\ngravity_strength = \"log(t)\"\n",
                           "gravity_strength at t = 0"),
                 std::pair("machine = \"slide\"\n", "the motion of grip jaw at t = "));
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                 "[[stage]]\n" +
                                     std::string(stage)),
                   {}, test::shipped());
    INFO(test::told(reading.mistakes, scratch.folder()));
    REQUIRE(reading.scene);
    const StageSpec& spec = reading.scene->stage[0];
    const Aggregate body = test::make_block(16, 4, 4, 0.1, reading.scene->work_piece().material);
    const Machine machine = stage_machine(spec, body, {});
    try {
        stage_legs(spec, machine, 4, body);
        FAIL("it has none");
    } catch (const SceneError& error) {
        REQUIRE(error.mistakes().size() == 1);
        CHECK(error.mistakes()[0].line == 6);
        INFO(error.what());
        CHECK(error.mistakes()[0].text.find(part) != std::string::npos);
    }
}
