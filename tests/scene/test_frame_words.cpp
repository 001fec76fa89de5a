// SPDX-License-Identifier: GPL-3.0-or-later
// Which axis and up a stage has where it leaves them to its machine.
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

using namespace swage;
using namespace swage::test;

namespace {

const std::string kGrip =
    "[[grip]]\nname = \"hold\"\nfrom = [-1, -1, -1]\nto = [1, 1, 1]\n"
    "[grip.motion]\nmove = [\"t\", 0, 0]\n";

// A stage with a machine of those words; what was told instead where the scene was refused.
struct Read {
    StageSpec stage;
    std::string told;
};
Read read(const std::string& machine, const std::string& stage) {
    const SceneFolder scratch;
    scratch.write("machines/mine.toml", "help = \"tries\"\n" + machine + kGrip);
    const SceneReading reading =
        read_scene(scratch.write("s.toml",
                                 "[mesh]\nfile = \"bar.obj\"\n[material]\nname = "
                                 "\"rubber\"\n[[stage]]\n" +
                                     stage),
                   {}, shipped());
    if (!reading.scene) return {{}, told(reading.mistakes, scratch.path())};
    CHECK(reading.mistakes.empty());
    return {reading.scene->stage.at(0), ""};
}
std::string words(const std::string& machine, const std::string& stage) {
    const Read one = read(machine, stage);
    if (!one.told.empty()) return one.told;
    return std::string(name_of(one.stage.axis)) + " " + name_of(one.stage.up);
}

const std::string kMine = "machine = \"mine\"\n";

}  // namespace

TEST_CASE("a machine's own axis and up each hold where a stage does not say that one") {
    const std::string sideways = "axis = \"x\"\nup = \"z\"\n";
    CHECK(words(sideways, kMine) == "x z");
    CHECK(words(sideways, kMine + "axis = \"x\"\n") == "x z");
    CHECK(words(sideways, kMine + "axis = \"y\"\n") == "y z");
    CHECK(words(sideways, kMine + "up = \"-y\"\n") == "x -y");
    CHECK(words("up = \"z\"\n", kMine + "axis = \"x\"\n") == "x z");
    CHECK(words("", kMine + "axis = \"x\"\n") == "x auto");
    CHECK(words("", kMine) == "auto auto");
    // One that would lie along what the stage says has no say.
    CHECK(words(sideways, kMine + "up = \"x\"\n") == "auto x");
    CHECK(words(sideways, kMine + "axis = \"z\"\n") == "z auto");
    CHECK(words("", "machine = \"floor\"\naxis = \"z\"\ngravity = 1\n") == "z y");
}

TEST_CASE("an upright machine's up is settled before it is known what lies on it") {
    const std::string upright = "upright = true\n";
    CHECK(words(upright, kMine) == "auto y");
    CHECK(words(upright, kMine + "axis = \"z\"\n") == "z y");
    CHECK(words(upright, kMine + "axis = \"y\"\nup = \"z\"\n") == "y z");
    CHECK(words(upright + "up = \"-z\"\n", kMine + "axis = \"y\"\n") == "y -z");
    CHECK(words(upright, kMine + "axis = \"y\"\n") ==
          "s.toml:7:8: axis = \"y\" points up with machine mine, whose up is \"y\"; choose "
          "another, or also give up\n");
    CHECK(words(upright + "axis = \"y\"\n", kMine) ==
          "machines/mine.toml:3:8: axis = \"y\" points up in an upright machine; choose another, "
          "or also give up = \"z\"\n");
}
