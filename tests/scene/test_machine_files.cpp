// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/catalogue.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

using namespace swage;
using namespace swage::test;

namespace {

const std::string kHead =
    "help = \"tries\"\n[parameter.reach]\nquantity = \"length\"\ndefault = "
    "\"0.5*length\"\n";
const std::string kGrip =
    "[[grip]]\nname = \"hold\"\nfrom = [0, 0, \"-reach\"]\nto = [1, 1, \"reach\"]\n";

std::string mistakes_in(const std::string& text) {
    const SceneFolder scratch;
    const MachineReading reading = read_machine(scratch.write("m.toml", text));
    CHECK(reading.machine.has_value() == (exit_code(reading.mistakes) == ExitCode::done));
    return told(reading.mistakes, scratch.path());
}

}  // namespace

TEST_CASE("a machine file reads into its spec, numbers and expressions alike") {
    const SceneFolder scratch;
    scratch.write("tool.obj", "v 0 0 0\n");
    const auto file = scratch.write("mine.toml", R"toml(
help = "a bit of each"
[parameter.turned]
quantity = "angle"
default = "90 deg"
low = 0
high = "2*pi"
help = "how far"
[parameter.radius]
quantity = "length"
default = "0.1*length"
[[tool]]
name = "roll"
shape = "cylinder"
radius = "radius"
length = "width + 2 mm"
hole = "radius/2"
rounding = "0.1*radius"
axis = [0, 1, 0]
at = [0, "-height", 0.25]
touch = [0, 1, 0]
gap = "1 mm"
friction = 0.2
color = [1, 0.5, 0]
finish = "matt"
contact_stiffness = 5
motion = { move = [0, "-radius*ramp(t, 0, 1)", 0], turn = "turned*t", axis = [1, 0, "radius"], pivot = ["roll_x", "roll_y", 0] }
[[tool]]
name = "block"
shape = "box"
size = ["length", 1, 1]
turn = "turned/2"
rounding = 0.1
at = ["roll_x", 0, 0]
[[tool]]
name = "ball"
shape = "sphere"
radius = 0.5
at = [0, 0, 0]
[[tool]]
name = "thing"
shape = "mesh"
file = "tool.obj"
length = "height"
at = [0, 0, 0]
[[grip]]
name = "hold"
from = ["-length/2", "-height", "-width"]
to = ["roll_x", "height", "width"]
[[blade]]
name = "edge"
edge = [[0, 0, "-width"], [0, 0, "width"], [1, 0, 0]]
thickness = "1 mm"
[blade.motion]
move = ["t", 0, 0]
[[check]]
holds = "radius < length"
otherwise = "choose a smaller radius"
)toml");

    const MachineReading reading = read_machine(file);
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.machine);
    CHECK(reading.mistakes.empty());
    const MachineSpec& machine = *reading.machine;
    CHECK(machine.name == "mine");
    CHECK(machine.help == "a bit of each");
    CHECK(machine.file == file);
    REQUIRE(machine.parameter.size() == 2);
    CHECK(machine.parameter[0].name == "turned");  // in the order of the file
    CHECK(machine.parameter[0].quantity == Quantity::angle);
    CHECK(machine.parameter[0].low == "0");
    CHECK(machine.parameter[0].high == "2*pi");
    CHECK(machine.parameter[0].help == "how far");
    CHECK(machine.parameter[1].low.empty());
    REQUIRE(machine.tool.size() == 4);
    const ToolSpec& roll = machine.tool[0];
    CHECK(roll.shape == ToolShape::cylinder);
    CHECK(roll.radius == "radius");
    CHECK(roll.length == "width + 2 mm");
    CHECK(roll.hole == "radius/2");
    CHECK(roll.rounding == "0.1*radius");
    CHECK(roll.axis == Expression3{"0", "1", "0"});
    CHECK(roll.at == Expression3{"0", "-height", "0.25"});
    CHECK(roll.touch == Expression3{"0", "1", "0"});
    CHECK(roll.gap == "1 mm");
    CHECK(roll.friction == "0.2");
    CHECK(roll.color.value().y() == Approx(0.2140).epsilon(1e-3));
    CHECK(roll.finish == Finish::matt);
    CHECK(roll.contact_stiffness == 5);
    CHECK(machine.tool[1].contact_stiffness == 0);
    CHECK(machine.tool[1].finish == Finish::metal);
    CHECK(roll.motion.turn == "turned*t");
    CHECK(roll.motion.axis == Expression3{"1", "0", "radius"});
    CHECK(roll.motion.pivot[1] == "roll_y");
    CHECK(machine.tool[1].size == Expression3{"length", "1", "1"});
    CHECK(machine.tool[1].rounding == "0.1");
    CHECK(machine.tool[1].turn == "turned/2");
    CHECK(machine.tool[1].friction.empty());
    CHECK(machine.tool[2].radius == "0.5");
    CHECK(machine.tool[3].mesh == scratch.path() / "tool.obj");
    CHECK(machine.grip.at(0).to[0] == "roll_x");
    REQUIRE(machine.blade.size() == 1);
    CHECK(machine.blade[0].edge.size() == 3);
    CHECK(machine.blade[0].thickness == "1 mm");
    CHECK(machine.blade[0].motion.move[0] == "t");
    CHECK(machine.check.at(0).holds == "radius < length");
}

TEST_CASE("mistakes in machine files are named at their letter") {
    struct Bad {
        const char* title;
        std::string text;
        std::vector<std::string> wanted;
    };
    const std::string tool =
        "[[tool]]\nname = \"a\"\nshape = \"cylinder\"\nradius = 1\nlength = "
        "1\nat = [0, 0, 0]\n";  // lines 9 to 14
    const Bad bad[] = {
        {"none", kHead + kGrip, {}},
        {"empty", "", {"m.toml: this machine has no [[tool]], [[grip]] or [[blade]]"}},
        {"variable",
         kHead + "[[grip]]\nname = \"a\"\nfrom = [0, 0, \"2*raech\"]\nto = [1, 1, 1]\n",
         {"7:18: from: unknown name \"raech\", did you mean \"reach\"?"}},
        {"later parameter",
         "[parameter.a]\nquantity = \"length\"\ndefault = \"b\"\n[parameter.b]\nquantity = "
         "\"length\"\ndefault = 1\n" +
             kGrip,
         {"3:12: default: unknown name \"b\"", "unknown name \"reach\"", "unknown name \"reach\""}},
        {"parameter of a later one",
         "[parameter.a]\nquantity = \"length\"\ndefault = \"2*b\"\n[parameter.b]\nquantity = "
         "\"length\"\ndefault = \"a\"\n" +
             kGrip,
         {"3:14: default: unknown name \"b\": a parameter can use only those above it",
          "unknown name \"reach\"", "unknown name \"reach\""}},
        {"parameter of itself",
         "[parameter.a]\nquantity = \"length\"\ndefault = 1\nhigh = \"2*a\"\n" + kGrip,
         {"4:11: high: unknown name \"a\": a parameter can use only those above it",
          "unknown name \"reach\"", "unknown name \"reach\""}},
        {"time outside a motion",
         kHead + "[[grip]]\nname = \"a\"\nfrom = [0, 0, \"t\"]\nto = [1, 1, \"reach\"]\n",
         {"7:16: from: unknown name \"t\""}},
        {"syntax",
         kHead + kGrip + "[grip.motion]\nturn = \"reach*(1 + 2\"\n",
         {"10:15: turn: this bracket is not closed"}},
        {"constant without value",
         kHead + kGrip + "[grip.motion]\nturn = \"1/0\"\n",
         {"10:9: turn: the expression does not give a finite number"}},
        {"no expression",
         kHead + kGrip + "[grip.motion]\nturn = true\n",
         {"10:8: turn is true or false; expected a number or an expression"}},
        {"two of three",
         kHead + kGrip + "[grip.motion]\nmove = [0, 1]\n",
         {"10:8: move must be three numbers or expressions"}},
        {"unknown key",
         kHead + kGrip + "[grip.motion]\nmoev = [0, 1, 2]\n",
         {"10:1: unknown key \"moev\" in [grip.motion], did you mean \"move\"?"}},
        {"wrong section",
         kHead + kGrip + "pivot = [0, 1, 2]\n",
         {"9:1: unknown key \"pivot\" in [[grip]]; it belongs in [grip.motion]"}},
        {"unknown section",
         kHead + kGrip + "[tools]\nx = 1\n",
         {"9:2: unknown key \"tools\" in the machine file, did you mean \"tool\"?"}},
        {"quantity",
         "[parameter.a]\nquantity = \"lenght\"\ndefault = 1\n" + kGrip,
         {"2:12: quantity = \"lenght\" is not one of", "\"reach\"", "\"reach\""}},
        {"no default",
         "[parameter.reach]\nquantity = \"length\"\n" + kGrip,
         {"1:1: [parameter.reach] needs \"default\""}},
        {"range upside down",
         kHead + "low = 3\nhigh = \"2 m\"\n" + kGrip,
         {"5:7: low = 3 m is more than high = 2 m"}},
        {"default outside",
         "[parameter.reach]\nquantity = \"number\"\ndefault = 3\nhigh = 2\n" + kGrip,
         {"3:11: default = 3 is not in the range from anything to 2"}},
        {"name of a unit",
         "[parameter.mm]\nquantity = \"number\"\ndefault = 3\n" + kHead + kGrip,
         {"the parameter's name \"mm\" is a function, a constant or a unit"}},
        {"name of a key",
         kHead + "[parameter.frames]\nquantity = \"number\"\ndefault = 3\n" + kGrip,
         {"5:12: the parameter's name \"frames\" is a key of every [[stage]]"}},
        {"name of the work-piece's",
         kHead + "[parameter.width]\nquantity = \"number\"\ndefault = 3\n" + kGrip,
         {"5:12: the parameter's name \"width\" is a variable of the work-piece"}},
        {"unused",
         kHead + "[parameter.idle]\nquantity = \"number\"\ndefault = 3\n" + kGrip,
         {"5:12: warning: no expression uses the parameter \"idle\""}},
        {"shape",
         kHead + kGrip + "[[tool]]\nname = \"a\"\nshape = \"cilinder\"\nat = [0, 0, 0]\n",
         {"11:9: shape = \"cilinder\" is not one of", "did you mean \"cylinder\"?"}},
        {"no size",
         kHead + kGrip + "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, 0]\n",
         {"9:1: [[tool]] needs \"radius\""}},
        {"zero size",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, 0]\n"
             "radius = \"3 - 3\"\n",
         {"13:10: radius = 0 must be more than 0"}},
        {"size beyond sense",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, \"1e9 m\"]\n"
             "radius = 1e300\n",
         {"12:13: at = 1e+09 m is out of range",
          "13:10: radius = 1e+300 m is out of range: it must be -1e+07 m to 1e+07 m"}},
        {"size of next to nothing",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, 1e-320]\n"
             "radius = \"1e-12 m\"\n",
         {"13:10: radius = 0.001 nm is out of range: it must be 1 nm to 1e+07 m"}},
        {"turn beyond sense",
         kHead + kGrip + "[grip.motion]\nturn = \"2*pi*1e7\"\n",
         {"10:8: turn = 3.6e+09 deg is out of range"}},
        {"size of another shape",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, 0]\nradius = "
             "1\nsize = [1, 1, 1]\n",
         {"14:1: unknown key \"size\" in [[tool]]"}},
        {"no direction",
         kHead + kGrip + tool + "axis = [0, 0, 0]\n",
         {"15:8: axis = [0, 0, 0] has no direction"}},
        {"motion about what changes",
         kHead + kGrip + "[grip.motion]\nturn = \"t\"\naxis = [0, \"t\", 1]\n",
         {"11:13: axis: unknown name \"t\""}},
        {"motion about nothing",
         kHead + kGrip + "[grip.motion]\nturn = \"t\"\naxis = [0, 0, \"1 - 1\"]\n",
         {"11:8: axis = [0, 0, 0] has no direction"}},
        {"gap without touch",
         kHead + kGrip + tool + "gap = 1\n",
         {"15:7: warning: gap has no effect without touch"}},
        {"mesh of a tool",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"mesh\"\nlength = "
             "1\nat = [0, 0, 0]\nfile = \"no.obj\"\n",
         {"14:8: the mesh \"no.obj\" does not exist (/tmp/"}},
        {"same name", kHead + kGrip + kGrip, {"10:8: two parts are called \"hold\""}},
        {"odd name",
         kHead + "[[grip]]\nname = \"a b\"\nfrom = [0, 0, 0]\nto = [1, 1, \"reach\"]\n",
         {"6:8: \"a b\" must be letters, digits and _, beginning with a letter"}},
        {"edge of one point",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [[0, 0, 0]]\n",
         {"11:8: edge must be at least two points, each of three numbers"}},
        {"edge of a point that does not change",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [0, 0, \"length\"]\n",
         {"11:8: a single point is no edge: give two, or let it change with `along`"}},
        {"edge of a point that does not change, after one that does",
         kHead + kGrip +
             "[[blade]]\nname = \"a\"\nedge = [0, 0, \"along\"]\n"
             "[[blade]]\nname = \"b\"\nedge = [0, 0, \"length\"]\n",
         {"14:8: a single point is no edge"}},
        {"points of an edge that has its own",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [[0, 0, 0], [0, 0, 1]]\npoints = 9\n",
         {"12:10: warning: points has no effect: this edge is given by its points"}},
        {"points of an edge",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [0, 0, \"along\"]\npoints = 1\n",
         {"12:10: points = 1 is out of range: it must be 2 to 1000"}},
        {"edge without length",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [[0, 0, 0], [0, 0, 0]]\n",
         {"11:8: edge begins and ends at the same point"}},
        {"check",
         kHead + kGrip + "[[check]]\nholds = \"reach <\"\n",
         {"10:17: holds: the expression ends too early", "9:1: [[check]] needs \"otherwise\""}},
        {"looks",
         kHead + kGrip + tool + "color = [0, 0, 2]\nfinish = \"gold\"\n",
         {"color = [0, 0, 2]: red, green and blue must each be 0 to 1", "finish"}},
        {"unit of another",
         kHead + kGrip + tool + "gap = \"1 s\"\ntouch = [0, 1, 0]\n",
         {"15:10: gap: "}},
        {"unit of a size",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nradius = \"3 kPa\"\n"
             "at = [0, 0, 0]\n",
         {"12:13: radius: "}},
        {"unit of a corner",
         kHead + "[[grip]]\nname = \"a\"\nfrom = [0, 0, \"1 N\"]\nto = [1, 1, \"reach\"]\n",
         {"7:18: from: "}},
        {"unit of an edge",
         kHead + kGrip + "[[blade]]\nname = \"b\"\nedge = [[0, 0, 0], [0, \"1 deg\", 0]]\n",
         {"11:27: edge: "}},
        {"unit of a motion", kHead + kGrip + "[grip.motion]\nturn = \"3 mm\"\n", {"10:11: turn: "}},
        {"unit of a default",
         "[parameter.reach]\nquantity = \"length\"\ndefault = \"20 deg\"\nhigh = \"1 kg\"\n" +
             kGrip,
         {"3:15: default: ", "4:11: high: "}},
        {"degrees without a word",
         "[parameter.reach]\nquantity = \"angle\"\ndefault = 90\nhigh = \"180\"\n" + kGrip,
         {"3:11: warning: default = 90 without a unit is 90 rad",
          "4:8: warning: high = 180 without a unit is 180 rad"}},
        {"a tool's place",
         kHead + "[parameter.a_x]\nquantity = \"length\"\ndefault = \"reach\"\n" + tool,
         {"9:8: \"a_x\" is a parameter, and would also be the position of tool \"a\"; choose "
          "another name"}},
        {"gravity",
         kHead + "[[grip]]\nname = \"gravity\"\nfrom = [0, 0, 0]\nto = [1, 1, \"reach\"]\n",
         {"6:8: \"gravity\" is reserved; choose another name"}},
        {"what would be a column of the curves twice",
         kHead + "[[grip]]\nname = \"machine\"\nfrom = [0, 0, 0]\nto = [1, 1, \"reach\"]\n",
         {"6:8: \"machine\" is reserved; choose another name"}},
        {"a tool whose work would be a column of the books",
         kHead + "[[grip]]\nname = \"friction\"\nfrom = [0, 0, 0]\nto = [1, 1, \"reach\"]\n",
         {"6:8: \"friction\" is reserved; choose another name"}},
        {"another unit behind a blank",
         kHead + kGrip +
             "[[tool]]\nname = \"a\"\nshape = \"sphere\"\nat = [0, 0, 0]\nradius = \" 3 N \"\n",
         {"13:14: radius: \"3 N\" is a force; expected a length"}},
        {"turn without need",
         kHead + kGrip + "[grip.motion]\naxis = [0, 0, 1]\n",
         {"10:8: warning: axis and pivot have no effect without turn"}},
    };
    for (const Bad& one : bad) {
        const std::string text = mistakes_in(one.text);
        INFO(one.title << "\n" << one.text << "---\n" << text);
        for (const std::string& wanted : one.wanted) {
            INFO(wanted);
            CHECK(text.find(wanted) != std::string::npos);
        }
        CHECK((one.wanted.empty() ? text.empty() : !text.empty()));
    }
}

TEST_CASE("a size or an axis that cannot be read gets no second mistake, about its value") {
    const std::string tool = "[[tool]]\nname = \"a\"\nat = [0, 0, 0]\nshape = ";
    const auto told_of = [&](const std::string& shape, const std::string& keys) {
        return mistakes_in(kHead + kGrip + tool + "\"" + shape + "\"\n" + keys + "\n");
    };
    CHECK(told_of("sphere", "radius = \"heigth\"") ==
          "m.toml:13:11: radius: unknown name \"heigth\", did you mean \"height\"?\n");
    CHECK(told_of("box", "size = [1, \"2*heigth\", -1]") ==
          "m.toml:13:15: size: unknown name \"heigth\", did you mean \"height\"?\nm.toml:13:24: "
          "size = -1 must be more than 0\n");
    CHECK(told_of("box", "size = [1, 1, 1]\naxis = [\"heigth\", 0, 0]") ==
          "m.toml:14:10: axis: unknown name \"heigth\", did you mean \"height\"?\n");
    CHECK(told_of("sphere", "radius = 1\naxis = [0, \"1 - 1\", 0]") ==
          "m.toml:14:8: axis = [0, 0, 0] has no direction\n");
}

TEST_CASE("a part's name in escaped or many-lined text is still placed at its text") {
    const std::string text =
        mistakes_in(kHead + kGrip + "[grip.motion]\nturn = \"\"\"\n2*qqq\"\"\"\n");
    CHECK(text == "m.toml:10:8: turn: unknown name \"qqq\"\n");
}

TEST_CASE("assets are found in the given folder first") {
    const SceneFolder scratch;
    scratch.write("machines/zzz.toml", kHead + kGrip);
    scratch.write("machines/readme.txt", "no machine");
    const AssetPaths assets = find_assets(scratch.path());
    REQUIRE_FALSE(assets.root.empty());
    CHECK(assets.root[0] == std::filesystem::canonical(scratch.path()));
    const auto machines = known_machines({{scratch.path()}}, {});
    REQUIRE(machines.size() == 1);
    CHECK(machines[0].name == "zzz");
    CHECK(machines[0].file == scratch.path() / "machines/zzz.toml");
    CHECK_THROWS_AS(find_assets(scratch.path() / "nowhere"), Error);
}

TEST_CASE("a machine stands that gives none of its parts a motion") {
    const auto stands = [](const std::string& more) {
        const SceneFolder scratch;
        const MachineReading reading = read_machine(scratch.write("m.toml", kHead + kGrip + more));
        REQUIRE(reading.machine);
        return reading.machine->stands();
    };
    CHECK(stands(""));
    CHECK_FALSE(stands("[grip.motion]\nturn = \"30 deg*t\"\n"));
    CHECK_FALSE(stands("[grip.motion]\nmove = [0, \"reach*t\", 0]\n"));
}

TEST_CASE("the duration of the stage is known where the time is, and nowhere else") {
    const std::string motion =
        "[grip.motion]\nmove = [\"0.5*reach*(t*duration)^2\", \"ramp(t*duration, 1, 2)\", 0]\n";
    CHECK(mistakes_in(kHead + kGrip + motion) == "");
    CHECK(mistakes_in(kHead + "[[grip]]\nname = \"hold\"\nfrom = [0, 0, \"-duration\"]\n"
                              "to = [1, 1, \"reach\"]\n")
              .find("duration") != std::string::npos);
}
