// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/machine_place.h"

#include "pipeline/stage_machine.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"
#include "tests/shared/block.h"
#include "tests/shared/json.h"

using namespace swage;

TEST_CASE(
    "it is told which axes of the world a machine's are, and nothing where they are the same") {
    const test::SceneFolder scratch;
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                 "[[stage]]\nmachine = \"hold\"\n[[stage.load]]\n"
                                 "force = [0, \"-10 N\", 0]\non = \"right\"\n"
                                 "[[stage]]\nmachine = \"hold\"\nup = \"-x\"\n"),
                   {}, test::shipped());
    REQUIRE(reading.scene);
    const SceneSpec& scene = *reading.scene;
    const Aggregate bar = test::make_block(4, 16, 4, 0.1, scene.work_piece().material);
    const Machine machine = stage_machine(scene.stage[0], bar, {}, Box{});
    const std::vector<MachinePlace> places = machine_places(scene, machine, bar, {}, Box{});
    REQUIRE(places.size() == 2);
    CHECK(places[0].axes == "the machine's x, y, z are the world's y, z, x");
    CHECK(places[1].axes == "the machine's x, y, z are the world's y, -x, z");
    // What is told is how forces go.
    const Json json = places_json(places);
    CHECK(json[0].at("axes") == Json({"y", "z", "x"}));
    Vec3 force = Vec3::Zero();
    for (const Vec3& one : machine.apparatus.load.at(0).force) force += one;
    CHECK((force - Vec3(0, 0, -10)).norm() < 1e-9);

    const Json load = json[0].at("loads").at(0);
    CHECK(load.at("name") == "load_1");
    CHECK(load.at("area_m2").get<double>() == Approx(0.16));
    CHECK(load.at("middle_by_machine_m").at(0).get<double>() == Approx(0.8));
    CHECK(load.at("middle_m").at(1).get<double>() ==
          Approx(machine.frame.world_from_work.translation.y() + 0.8));
    CHECK(load.at("parts").size() == 1);
    CHECK(places[0].load ==
          std::vector<std::string>{"load_1 acts on 0.16 m2 about [80 cm, 0 m, 0 m]"});
    CHECK(json[1].at("loads").empty());

    CHECK(places[0].tools.empty());  // it holds

    const Aggregate along_x = test::make_block(16, 4, 4, 0.1, scene.work_piece().material);
    CHECK(axes_text(stage_frame(scene.stage[0], along_x, Box{})) == "");
}

TEST_CASE("what a load pushes with is told at the strength that acts, and which way") {
    const test::SceneFolder scratch;
    const Aggregate bar = test::make_block(16, 4, 4, 0.1, Material{});
    const auto told = [&](const std::string& load) {
        const SceneReading reading = read_scene(
            scratch.write("s.toml",
                          "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                          "[[stage]]\nmachine = \"hold\"\n[[stage.load]]\non = \"right\"\n" +
                              load),
            {}, test::shipped());
        REQUIRE(reading.scene);
        const Machine machine = stage_machine(reading.scene->stage[0], bar, {}, Box{});
        const std::vector<MachinePlace> places =
            machine_places(*reading.scene, machine, bar, {}, Box{});
        const std::vector<std::string>& push = places.at(0).push;
        REQUIRE(push.size() <= 1);
        return std::pair(push.empty() ? "" : push[0], Json(places[0].loads_json.at(0)));
    };
    const auto check = [&](const std::string& load, const std::string& text, const char* key,
                           const Json& value, double least, double most) {
        INFO(load);
        const auto [push, json] = told(load);
        CHECK(push == text);
        if (json.at(key).is_array()) {
            for (int k = 0; k < 3; ++k) {
                const double wanted = value[k].get<double>();
                CHECK(json.at(key)[k].get<double>() == Approx(wanted).margin(1e-9));
            }
        } else {
            CHECK(json.at(key) == value);
        }
        CHECK(json.at("strength_least") == least);
        CHECK(json.at("strength_most") == most);
    };
    const std::string force = "force = [0, \"100 N\", 0]\n", with = "load_1 pushes with ";
    const auto up = [](double newtons) { return Json::array({0.0, newtons, 0.0}); };
    check(force, with + "up to 100 N along the world's y", "force_N", up(100), 0, 1);
    check(force + "strength = 1\n", with + "100 N along the world's y", "force_N", up(100), 1, 1);
    check(force + "strength = 2\n", with + "200 N along the world's y", "force_N", up(200), 2, 2);
    check(force + "strength = \"-5*t\"\n", with + "up to 500 N along the world's -y", "force_N",
          up(-500), -5, 0);
    check(force + "strength = \"t\"\n", with + "up to 100 N along the world's y", "force_N",
          up(100), 0, 1);
    check(force + "strength = \"1 - 3*t\"\n",
          with + "up to 200 N along the world's -y, and up to 100 N the other way", "force_N",
          up(-200), -2, 1);
    check(force + "strength = \"0*t\"\n", "", "force_N", up(0), 0, 0);
    const std::string pressure = "pressure = \"1 kPa\"\n";
    check(pressure + "strength = 1\n", "load_1 presses with 1 kPa", "pressure_Pa", 1000.0, 1, 1);
    check(pressure + "strength = \"-t\"\n", "load_1 sucks with up to 1 kPa", "pressure_Pa", -1000.0,
          -1, 0);
    check("pressure = \"-1 kPa\"\nstrength = \"4*t - 1\"\n",
          "load_1 sucks with up to 3 kPa, and presses with up to 1 kPa", "pressure_Pa", -3000.0, -1,
          3);
    // To a thousandth of a unit vector, without what is rounded of 0.
    CHECK(told("force = [\"0.0001 N\", \"-10 N\", \"0.1 N\"]\n").first ==
          with + "up to 10 N along the world's [0, -1, 0.01]");
}

TEST_CASE("it is told from which side of the world tools come, and what brings them from above") {
    const test::SceneFolder scratch;
    const auto told = [&](const std::string& stage, const Aggregate& block) {
        const SceneReading reading =
            read_scene(scratch.write("s.toml",
                                     "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n"
                                     "[[stage]]\nmachine = " +
                                         stage),
                       {}, test::shipped());
        REQUIRE(reading.scene);
        const StageSpec& spec = reading.scene->stage[0];
        return tools_text(spec, stage_frame(spec, block, Box{}));
    };
    const Aggregate lies = test::make_block(16, 4, 4, 0.1, Material{}),
                    stands = test::make_block(4, 16, 4, 0.1, Material{});
    const std::string up = " (the machine's y, set by up)", y = " from the world's y" + up;
    CHECK(told("\"press\"", lies) == "plate comes" + y);
    CHECK(told("\"bend\"", lies) == "left and right come" + y);
    CHECK(told("\"press\"\nup = \"-z\"", lies) == "plate comes from the world's -z" + up);
    CHECK(told("\"press\"", stands) ==
          "plate comes from the world's z" + up +
              ", as the longest side is upright; axis = \"x\" or \"z\" brings it from y");
    CHECK(told("\"bend\"", stands) == "left and right come from the world's z" + up);
    for (const char* axis : {"x", "z"}) {
        CHECK(told("\"press\"\naxis = \"" + std::string(axis) + "\"", stands) == "plate comes" + y);
    }
    for (const char* machine : {"hold", "floor", "wring", "twist"}) {
        CHECK(told("\"" + std::string(machine) + "\"\n", lies).empty());
    }
}
