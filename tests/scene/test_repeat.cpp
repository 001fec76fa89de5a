// SPDX-License-Identifier: GPL-3.0-or-later
// Parts with `repeat`, in machine files and in the scenes that use them.
#include "scene/read_machine.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

const std::string kRolls =
    "help = \"rolls\"\n[parameter.rolls]\nquantity = \"number\"\ndefault = 3\nlow = 0\nhigh = 50\n"
    "help = \"how many\"\n[parameter.radius]\nquantity = \"length\"\ndefault = \"0.1*length\"\n"
    "[[tool]]\nname = \"roll\"\nshape = \"sphere\"\nradius = \"radius\"\n";
const std::string kAt = "at = [\"number*radius\", \"height\", 0]\n";
const std::string kTurns =
    "motion = { turn = \"t*stop\", pivot = [\"roll_x\", \"roll_y\", \"roll_z\"] }\n";

std::string mistakes_of(const std::string& text) {
    const SceneFolder scratch;
    return told(read_machine(scratch.write("m.toml", text)).mistakes, scratch.path());
}

// The parts of the first stage, and what was wrong with it.
std::pair<std::vector<std::string>, std::string> parts_with(const std::string& lines,
                                                            const std::string& render = "") {
    const SceneFolder scratch;
    scratch.write("rolls.toml", kRolls + "repeat = \"rolls\"\n" + kAt + kTurns);
    Parts parts = with(&Parts::stage, "[[stage]]\nmachine = \"./rolls.toml\"\n" + lines);
    parts.rest += render;
    const SceneReading reading = read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    std::vector<std::string> names;
    if (reading.scene) {
        for (const ToolSpec& tool : reading.scene->stage[0].machine.tool) {
            names.push_back(tool.name);
        }
    }
    return {names, told(reading.mistakes, scratch.path())};
}

}  // namespace

TEST_CASE("a scene sees as many parts as the parameter says") {
    using Names = std::vector<std::string>;
    CHECK(parts_with("").first == Names{"roll_1", "roll_2", "roll_3"});
    CHECK(parts_with("rolls = 1\n").first == Names{"roll_1"});
    const auto [limited, told] =
        parts_with("rolls = 2\n[[stage.limit]]\npart = \"roll_2\"\ntorque = \"2 N m\"\n");
    INFO(told);
    CHECK(limited.size() == 2);
}

TEST_CASE("what a scene asks of parts that are not there is told at its place") {
    CHECK(parts_with("rolls = 2.5\n").second ==
          "s.toml:9:9: machine rolls: roll is repeated 2.5 times (\"rolls\"): it must be a whole "
          "number from 0 to 100\n");
    CHECK(parts_with("rolls = -3\n").second ==
          "s.toml:9:9: rolls = -3 is out of range: machine rolls takes 0 to 50\n");
    CHECK(parts_with("rolls = 2\n[[stage.limit]]\npart = \"roll_3\"\nforce = \"2 N\"\n")
              .second.find("machine rolls has no tool or grip \"roll_3\"") != std::string::npos);
    CHECK(parts_with("rolls = 2\n", "hide = [\"roll_1\", \"roll\"]\n").second.empty());
    CHECK(
        parts_with("rolls = 2\n", "hide = [\"roll_2\", \"roll_3\", 4]\n").second ==
        "s.toml:12:19: hide: \"roll_3\" is no tool, grip or blade of any machine of the scene, did "
        "you mean \"roll_1\"? There are roll_1, roll_2\n"
        "s.toml:12:29: hide: a whole number is no tool, grip or blade of any machine of the scene; "
        "there are roll_1, roll_2\n");
    CHECK(parts_with("", "hide = \"roll\"\n").second ==
          "s.toml:11:8: hide must be a list of names, such as [\"plate\"]\n");
}

TEST_CASE("mistakes about repeated parts in machine files are found at their letter") {
    const std::string end = "[[grip]]\nname = \"roll_2\"\nfrom = [0, 0, 0]\nto = [1, 1, 1]\n";
    CHECK(mistakes_of(kRolls + "repeat = \"rolls\"\n" + kAt + kTurns).empty());
    CHECK(mistakes_of(kRolls + kAt)
              .find("15:8: at: unknown name \"number\": only a part with repeat has one") !=
          std::string::npos);
    for (const std::string count : {"radius", "length/spacing"}) {
        CHECK(mistakes_of(kRolls + "repeat = \"" + count + "\"\n" + kAt)
                  .find("repeat can use only parameters whose default does not depend on the "
                        "work-piece") != std::string::npos);
    }
    for (const std::string count : {"101", "-1", "2.5", "\"101\"", "\"2*51 - 1\""}) {
        INFO(count);
        CHECK(mistakes_of(kRolls + "repeat = " + count + "\n" + kAt)
                  .find("must be a whole number from 0 to 100") != std::string::npos);
    }
    CHECK(mistakes_of(kRolls + "repeat = \"2*50\"\n" + kAt).find("must be") == std::string::npos);
    CHECK(mistakes_of(kRolls + "repeat = 3\n" + kAt + end)
              .find("\"roll_2\" is also the name of a repeated \"roll\"; choose another "
                    "name") != std::string::npos);
    CHECK(
        mistakes_of(kRolls + "repeat = 3\n" + kAt +
                    "[[tool]]\nname = \"b\"\nshape = \"sphere\"\nradius = 1\nat = [\"roll_x\", 0, "
                    "0]\n")
            .find("unknown name \"roll_x\": only its own motion sees the middle of a tool that "
                  "is repeated") != std::string::npos);
    for (const std::string expression : {"roll_2_x", "height + roll_13_x"}) {
        const std::string told = mistakes_of(
            kRolls + "repeat = 3\n" + kAt + "motion = { move = [\"" + expression + "\", 0, 0] }\n");
        INFO(told);
        CHECK(told.find("_x\": only its own motion sees the middle of a tool that is repeated, as "
                        "roll_x") != std::string::npos);
    }
    CHECK(mistakes_of("[parameter.roll_12_x]\nquantity = \"length\"\ndefault = 1\n" + kRolls +
                      "repeat = 3\n" + kAt)
              .find("\"roll_12_x\" is a parameter, and would also be the position of tool "
                    "\"roll_12\"") != std::string::npos);
    CHECK(mistakes_of("[parameter.number]\nquantity = \"number\"\ndefault = 1\n[[grip]]\nname = "
                      "\"a\"\nfrom = [\"number\", 0, 0]\nto = [1, 1, 1]\n")
              .find("the parameter's name \"number\" is the number of a repeated part; choose "
                    "another") != std::string::npos);
}
