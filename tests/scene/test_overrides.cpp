// SPDX-License-Identifier: GPL-3.0-or-later
// What --set means: by the names that messages use, and of sections that it makes itself.
#include "scene/catalogue.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using test::Parts;
using test::SceneFolder;

namespace {

const std::string kBody = "[[body]]\nfile = \"bar.obj\"\nat = [0, 1, 0]\n";

// With two bodies that nobody named, between two that somebody did.
std::string with_bodies() {
    const auto named = [](const std::string& name) { return kBody + "name = \"" + name + "\"\n"; };
    Parts parts;
    parts.mold += named("first") + kBody + kBody + named("last");
    parts.stage = "[[stage]]\nmachine = \"floor\"\ngravity = 9.81\n";
    return parts.text();
}

SceneSpec scene_with(const std::string& text, const std::vector<std::string>& overrides) {
    const SceneFolder scratch;
    SceneReading reading = read_scene(scratch.write("s.toml", text), overrides, test::shipped());
    INFO(test::told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    return std::move(*reading.scene);
}

}  // namespace

TEST_CASE("an override finds bodies, stages and loads by the names that messages give them") {
    const SceneSpec scene =
        scene_with(with_bodies(), {"body.body-3.velocity=[1,0,0]", "body.4.velocity=[2,0,0]",
                                   "body.body-4.spin=[0,0,3]", "stage.1-floor.drop=2 cm"});
    REQUIRE(scene.body.size() == 5);
    for (std::size_t b : {1, 2, 3, 4}) {
        INFO(scene.body[b].name);
        CHECK(scene.body[b].start.velocity.x() == (b == 2 ? 1 : b == 4 ? 2 : 0));
        CHECK(scene.body[b].start.spin.z() == (b == 3 ? 3 : 0));
    }
    CHECK(scene.stage[0].parameter.at("drop") == Approx(0.02));

    const std::string load =
        "[[stage.load]]\npressure = \"1 Pa\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n";
    const std::string other =
        "[[stage.load]]\nname = \"wind\"\npressure = \"1 Pa\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n";
    Parts loaded;
    loaded.stage = "[[stage]]\nmachine = \"hold\"\n" + load + other + load;
    const SceneSpec pressed = scene_with(loaded.text(), {"stage.1-hold.load.load_3.pressure=7 Pa"});
    const std::vector<LoadSpec>& loads = pressed.stage[0].machine.load;
    REQUIRE(loads.size() == 3);
    CHECK(loads[2].name == "load_3");
    CHECK(loads[0].pressure.text != loads[2].pressure.text);
}

TEST_CASE("a machine in a file gives a stage the same name to an override") {
    SceneFolder scratch;
    scratch.write("own/odd.toml", "[[grip]]\nname = \"a\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n");
    Parts parts;
    parts.stage = "[[stage]]\nmachine = \"own/odd.toml\"\ngravity = 9.81\n";
    const SceneReading reading = read_scene(scratch.write("s.toml", parts.text()),
                                            {"stage.1-odd.frames=7"}, test::shipped());
    INFO(test::told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    CHECK(reading.scene->stage[0].name == "1-odd");
    CHECK(reading.scene->stage[0].frames == 7);
}

TEST_CASE("an override of none of several lists what they are called") {
    CHECK(test::mistakes_in(with_bodies(), {"body.body-9.velocity=[1,0,0]"})
              .find("there is no body \"body-9\"") != std::string::npos);
    CHECK(test::mistakes_in(with_bodies(), {"body.9.velocity=[1,0,0]"}) ==
          "--set body.9.velocity=[1,0,0]: there is no body \"9\"; there are 4: first, body-3, "
          "body-4, last (1 to 4 in the file's order; * for all)\n");
    CHECK(test::mistakes_in(Parts().text(), {"stage.3.angle=1"}) ==
          "--set stage.3.angle=1: there is no stage \"3\"; there is 1: 1-bend\n");
}

TEST_CASE("a material that overrides alone give is one") {
    Parts parts;
    parts.material = "";
    const SceneSpec scene =
        scene_with(parts.text(), {"material.young_modulus=2 MPa", "material.density=1000"});
    CHECK(scene.work_piece().material.young_modulus == 2e6);
    CHECK(scene.work_piece().material.density == 1000);
    CHECK(test::mistakes_in(parts.text(), {"material.young_modulus=2 MPa"})
              .find("[material] needs \"density\"") != std::string::npos);
    CHECK(test::mistakes_in(parts.text()).find("the section [material] is missing") !=
          std::string::npos);
}

TEST_CASE("a body's own material that an override gives is one, or tells what it lacks") {
    const SceneSpec scene =
        scene_with(with_bodies(), {"body.1.material={young_modulus=\"3 MPa\",density=1000}"});
    CHECK(scene.body[1].material.young_modulus == 3e6);
    CHECK(scene.body[2].material.name == "rubber");
    const std::string told = test::mistakes_in(with_bodies(), {"body.1.material.friction=0.9"});
    INFO(told);
    CHECK(told.find("[body.material] needs \"young_modulus\"") != std::string::npos);
    CHECK(told.find("is missing") == std::string::npos);
    CHECK(test::mistakes_in(with_bodies(), {"body.1.material={}"}).find("[body.material]") !=
          std::string::npos);
}

TEST_CASE("an inset's damping without effect in implicit steps is told") {
    const auto told = [](const std::string& inset) {
        Parts parts;
        parts.mold += "[[inset]]\nto = [0.5, 1, 1]\nname = \"copper\"\n" + inset;
        parts.stage = "[[stage]]\nmachine = \"hold\"\ngravity = 9.81\nsolver = \"implicit\"\n";
        const std::string all = test::mistakes_in(parts.text());
        INFO(all);
        CHECK(all.find("mistake") == std::string::npos);
        return all.find("damping_ratio has no effect with solver = \"implicit\"") !=
               std::string::npos;
    };
    CHECK(told("damping_ratio = 0.1\n"));
    CHECK_FALSE(told("damping_ratio = 0\n"));
    CHECK_FALSE(told(""));
}

TEST_CASE("a material of the scene's folder takes the place of one that ships, in lists too") {
    const SceneFolder scratch;
    scratch.write("materials.toml",
                  "[copper]\nyoung_modulus = \"1 GPa\"\ndensity = 1000\n"
                  "[own]\nyoung_modulus = \"1 GPa\"\ndensity = 1000\n");
    const MaterialCatalogue all = material_catalogue(test::shipped(), scratch.path());
    REQUIRE(all.look.size() == all.material.size());
    const auto is_copper = [](const Material& one) { return one.name == "copper"; };
    CHECK(std::count_if(all.material.begin(), all.material.end(), is_copper) == 1);
    const auto copper = std::find_if(all.material.begin(), all.material.end(), is_copper);
    REQUIRE(copper != all.material.end());
    CHECK(copper->young_modulus == 1e9);
    CHECK(material_catalogue(test::shipped(), {}).material.size() + 1 == all.material.size());
}
