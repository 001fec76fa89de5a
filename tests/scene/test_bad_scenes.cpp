// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with something wrong in them: every mistake is found, at its place, with what to do.
#include <sys/stat.h>

#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("the scene that the others vary is right") { CHECK(mistakes_in(Parts().text()) == ""); }

TEST_CASE("unknown keys and sections get the nearest known one") {
    check_all({
        {"typo",
         material("yeild = 3"),
         {"s.toml:5:1: unknown key \"yeild\" in [material], did you mean \"yield_stress\"?"}},
        {"typo of a parameter",
         stage("angel = 3"),
         {"s.toml:9:1: unknown key \"angel\" in [[stage]] with machine \"bend\", did you mean "
          "\"angle\"?"}},
        {"known elsewhere as", material("E = 3"), {"did you mean \"young_modulus\"?"}},
        {"nothing near",
         material("colour = 3"),
         {"5:1: unknown key \"colour\" in [material]; known: name, mechanics,"}},
        {"section",
         with(&Parts::material, "[materail]\nname = \"rubber\"\n"),
         {"s.toml:3:2: unknown section [materail], did you mean [material]?",
          "s.toml: the section [material] is missing"}},
        {"section far off",
         with(&Parts::rest, "[physics]\ng = 3\n"),
         {"10:2: unknown section [physics]; known: mesh, material"}},
        {"key in the wrong section",
         render("across = 4"),
         {"11:1: unknown key \"across\" in [render]; it belongs in [mold]"}},
        {"key of a stage",
         render("frames = 4"),
         {"11:1: unknown key \"frames\" in [render]; it belongs in [[stage]]\n"}},
        {"parameter of another machine",
         with(&Parts::rest, "[[stage]]\nmachine = \"twist\"\noverhang = 3\n"),
         {"12:1: unknown key \"overhang\" in [[stage]] with machine \"twist\"; it belongs in "
          "[[stage]] with machine \"bend\""}},
        {"key above all sections",
         with(&Parts::mesh, "frames = 3\n[mesh]\nfile = \"bar.obj\"\n"),
         {"1:1: unknown key \"frames\" in no section; it belongs in [[stage]]"}},
        {"in the camera",
         render("camera = {azimut = 1}"),
         {"11:11: unknown key \"azimut\" in [render.camera], did you mean \"azimuth\"?"}},
        {"stage in single brackets",
         with(&Parts::stage, "[stage]\nmachine = \"bend\"\n"),
         {"7:1: write [[stage]] in double brackets, as there can be several"}},
        {"section as a value",
         with(&Parts::mold, "[[mold]]\nacross = 3\n"),
         {"5:1: mold is an array; write it as a section [mold]"}},
    });
}

TEST_CASE("broken lines are named, and the rest is read all the same") {
    check_all({
        {"value missing",
         stage("frames =\nanlge = 3"),
         {"9:9: frames has no value", "10:1: unknown key \"anlge\""}},
        {"key twice",
         stage("frames = 3\nremold = true\nframes = 4"),
         {"11:1: \"frames\" is given twice, first on line 9"}},
        {"section twice",
         with(&Parts::rest, "[mold]\nacross = 3\n"),
         {"10:1: [mold] is given twice, first on line 5"}},
        {"decimal comma",
         with(&Parts::mold, "[mold]\nspacing = 1,5\n"),
         {"6:11: 1,5 has a decimal comma; write 1.5"}},
        {"no quotes",
         with(&Parts::mold, "[mold]\nspacing = 5 mm\n"),
         {"6:11: a value with a unit needs quotes: spacing = \"5 mm\""}},
        {"no quotes about a word",
         with(&Parts::mold, "[mold]\nkind = block\n"),
         {"6:8: text needs quotes: kind = \"block\""}},
        {"rubbish after a number", stage("frames = 1e5x"), {"9:10: 1e5x is not a number"}},
        {"apples", stage("frames = 10 apples"), {"9:10: 10 apples is not a number"}},
        {"octal", stage("frames = 010"), {"9:10: a number cannot begin with 0: write 10"}},
        {"too large", stage("duration = 1e999"), {"9:12: \"1e999\" is too large for a number"}},
        {"open quote", stage("name = \"a"), {"9:8: the closing quote is missing"}},
        {"yes", stage("remold = yes"), {"9:10: write true"}},
        {"no key", stage("just words"), {"9:6: cannot be parsed:"}},
        {"two at once",
         stage("frames = \nduration = 1,5\nangle = 3 deg"),
         {"9:9:", "10:12: 1,5 has a decimal comma", "11:9: a value with a unit"}},
    });
}

TEST_CASE("values of the wrong kind, unit or form are refused") {
    check_all({
        {"text for a number",
         stage("frames = \"sixty\""),
         {"9:11: frames: \"sixty\" is not a number; expected a plain number"}},
        {"decimal comma in a text",
         stage("angle = \"1,5 deg\""),
         {"9:11: angle: \"1,5 deg\" has a decimal comma; write \"1.5 deg\""}},
        {"rubbish after a unit",
         stage("radius = \"10 apples\""),
         {"9:14: radius: unknown unit \"apples\"; expected a length (m, cm, mm, um, ...)"}},
        {"another dimension",
         stage("radius = \"10 kg\""),
         {"9:14: radius: \"10 kg\" is a mass; expected a length"}},
        {"other case",
         material("young_modulus = \"3 mpa\""),
         {"5:20: young_modulus: unknown unit \"mpa\", did you mean \"MPa\"?"}},
        {"hexadecimal", material("density = \"0x10\""), {"5:12: density: \"0x10\" is hexadecimal"}},
        {"nan", material("density = nan"), {"5:11: density is not a finite number"}},
        {"inf", stage("radius = inf"), {"9:10: radius is not a finite number"}},
        {"inf in a text", material("density = \"inf\""), {"\"inf\" is not a finite number"}},
        {"inf of another unit",
         material("yield_stress = \"inf mm\""),
         {"\"inf\" is not a finite number"}},
        {"minus inf", material("yield_stress = \"-inf\""), {"\"inf\" is not a finite number"}},
        {"nan in a text", material("density = \"nan\""), {"\"nan\" is not a finite number"}},
        {"overflow", material("density = \"1e999 kg/m3\""), {"5:12: density: \"1e999\" is too"}},
        {"truth for a number",
         stage("frames = true"),
         {"9:10: frames is true or false; expected a plain number"}},
        {"truth for an acceleration",
         stage("gravity = true"),
         {"gravity is true or false; expected an acceleration, such as "}},
        {"number for a truth",
         stage("remold = 1"),
         {"9:10: remold must be true or false, without quotes"}},
        {"number for a text",
         stage("name = 3"),
         {"9:8: name is a whole number; expected text in quotes"}},
        {"date", stage("frames = 2020-01-01"), {"9:10: frames is a date"}},
        {"array", material("density = [1]"), {"5:11: density is an array; expected a density"}},
        {"unknown choice",
         with(&Parts::mold, "[mold]\nkind = \"blok\"\n"),
         {"6:8: kind = \"blok\" is not one of \"shape\", \"block\", did you mean \"block\"?"}},
        {"letters outside ASCII count as one",
         stage("radius = \"3 \u00b5\u00b5m\""),
         {"9:13: radius: unknown unit \"\u00b5\u00b5m\""}},
    });
    CHECK(mistakes_in(stage("frames = 0x10").text()) == "");  // TOML's own hexadecimal is exact
    CHECK(mistakes_in(stage("frames = +16").text()) == "");
}

TEST_CASE("values out of range are refused with the range") {
    check_all({
        {"negative stiffness",
         material("young_modulus = -5"),
         {"5:17: young_modulus = -5 Pa is out of range: it must be 0.001 Pa to 1e+06 GPa"}},
        {"zero stiffness", material("young_modulus = 0"), {"0.001 Pa to 1e+06 GPa"}},
        {"zero density",
         material("density = -0"),
         {"5:11: density = 0 kg/m3 is out of range: it must be 0.001 kg/m3 to 1e+09 kg/m3"}},
        {"zero yield stress", material("yield_stress = 0"), {"more than 0 Pa"}},
        {"hardening alone",
         material("hardening = \"1 MPa\""),
         {"5:13: warning: hardening has no effect without yield_stress"}},
        {"softening", material("hardening = -1\nyield_stress = 3"), {"must be 0 Pa to 1e+06 GPa"}},
        {"incompressible",
         material("poisson_ratio = 0.5"),
         {"5:17: poisson_ratio = 0.5 is out of range: it must be 0 to 0.49"}},
        {"beyond", material("poisson_ratio = 0.6"), {"it must be 0 to 0.49"}},
        {"auxetic", material("poisson_ratio = -0.3"), {"it must be 0 to 0.49"}},
        {"without effect",
         material("poisson_ratio = 0.3\nmechanics = \"springs\""),
         {"5:17: warning: poisson_ratio has no effect: a lattice of springs always has 0.25"}},
        {"overdamped",
         material("damping_ratio = 1.5"),
         {"5:17: damping_ratio = 1.5 is out of range: it must be 0 to 0.3"}},
        {"negative damping", material("damping_ratio = -0.1"), {"must be 0 to 0.3\n"}},
        {"strength alone",
         material("strength = \"3 MPa\""),
         {"5:12: strength needs toughness: the energy per area of a new crack, such as \"10 "
          "J/m2\""}},
        {"neo-hookean foam",
         material("elasticity = \"neo-hookean\"\npoisson_ratio = 0.3"),
         {"5:14: warning: neo-hookean with poisson_ratio = 0.3 is too soft"}},
        {"toughness alone",
         material("toughness = \"3 J/m2\""),
         {"5:13: warning: toughness has no effect without strength"}},
        {"zero toughness",
         material("toughness = 0\nstrength = 3\nelasticity = \"hencky\""),
         {"5:13: toughness = 0 J/m2 is out of range: it must be more than 0 J/m2"}},
        {"toughness in another unit",
         material("strength = \"3 kPa\"\ntoughness = \"3 MPa\"\nelasticity = \"hencky\""),
         {"toughness: \"3 MPa\" is a stress; expected a toughness"}},
        {"stronger than stiff",
         material("young_modulus = \"1 GPa\"\nstrength = \"0.2 GPa\"\ntoughness = 3\n"
                  "elasticity = \"hencky\""),
         {"6:12: a strength of 200 MPa is too high for a young_modulus of 1 GPa"}},
        {"breaking rubber",
         material("elasticity = \"neo-hookean\"\nstrength = \"1 kPa\"\ntoughness = 3"),
         {"neo-hookean matter does not break"}},
        {"breaking foam",
         material("elasticity = \"storakers\"\nstrength = \"1 kPa\"\ntoughness = 3"),
         {"storakers matter does not break"}},
        {"metal without its unit",
         with(&Parts::material,
              "[material]\nname = \"structural_steel\"\nyoung_modulus = 210\n"
              "density = 7.85\n"),
         {"5:17: warning: 210 Pa is 1.0e-09 of what structural_steel has, 210 GPa: is a unit "
          "missing",
          "6:11: warning: 7.85 kg/m3 is 1.0e-03 of what structural_steel has, 7850 kg/m3"}},
        {"glass in other units",
         with(&Parts::material,
              "[material]\nname = \"glass\"\nstrength = \"40 kPa\"\ntoughness = 8e-3\n"),
         {"5:12: warning: 40 kPa is 8.9e-04 of what glass has, 45 MPa",
          "6:13: warning: 0.008 J/m2 is 1.4e-03 of what glass has, 5.7 J/m2"}},
        {"steel that yields in another unit",
         with(&Parts::material,
              "[material]\nname = \"structural_steel\"\nyield_stress = \"235 kPa\"\n"),
         {"5:16: warning: 235 kPa is 1.0e-03 of what structural_steel has, 235 MPa"}},
        {"foam that is told to yield",
         material("elasticity = \"storakers\"\nyield_stress = \"1 kPa\""),
         {"storakers matter does not yield"}},
        {"negative friction", material("friction = -1"), {"5:12: friction = -1 is out of range"}},
        {"static friction below friction",
         material("friction = 0.4\nstatic_friction = 0.3"),
         {"6:19: static_friction = 0.3 is less than friction = 0.4"}},
        {"restitution above one",
         material("restitution = 1.1"),
         {"5:15: restitution = 1.1 is out of range"}},
        {"negative stickiness",
         material("stickiness = \"-1 Pa\""),
         {"5:14: stickiness = -1 Pa is out of range"}},
        {"stiffer than anything",
         material("young_modulus = \"1e300 Pa\""),
         {"5:17: young_modulus = 1e+291 GPa is out of range"}},
        {"lighter than anything",
         material("density = \"1e-9 kg/m3\""),
         {"5:11: density = 1e-09 kg/m3 is out of range"}},
        {"wild friction", material("friction = 1e9"), {"5:12: warning: friction = 1e+09 is more"}},
        {"degrees without a unit",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\nturn = [0, 30, 0]\n"),
         {"3:12: warning: turn = 30 without a unit is 30 rad, which is 4.775 turns; write degrees "
          "as \"30 deg\""}},
        {"no cell",
         with(&Parts::mold, "[mold]\nacross = 0\n"),
         {"6:10: across = 0 is out of range: it must be 1 to 1000000"}},
        {"negative", with(&Parts::mold, "[mold]\nacross = -4\n"), {"6:10: across = -4 is out"}},
        {"half a cell",
         with(&Parts::mold, "[mold]\nacross = 2.5\n"),
         {"6:10: across = 2.5 must be a whole number"}},
        {"no spacing", with(&Parts::mold, "[mold]\nspacing = \"0 mm\"\n"), {"6:11: spacing = 0 m"}},
        {"both",
         with(&Parts::mold, "[mold]\nacross = 3\nspacing = \"1 mm\"\n"),
         {"7:11: across and spacing set the same thing: give one of them"}},
        {"no length",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\nlength = 0\n"),
         {"3:10: length = 0 m is out of range: it must be more than 0 m"}},
        {"no frames",
         stage("frames = 0"),
         {"9:10: frames = 0 is out of range: it must be 1 to 1000000000"}},
        {"no time", stage("duration = \"0 s\""), {"9:12: duration = 0 s is out of range"}},
        {"no rate", render("fps = 0"), {"11:7: fps = 0 is out of range: it must be 1 to 240"}},
        {"negative rate", render("fps = -30"), {"11:7: fps = -30 is out of range"}},
        {"no film's rate",
         render("fps = 23.9"),
         {"11:7: fps = 23.9 is no rate of films: it has to be a whole number, 1 to 240, or 23.976, "
          "29.97, 47.952, 59.94 or 119.88"}},
        {"no film's ratio",
         render("fps = \"24001/1001\""),
         {"11:7: fps = \"24001/1001\" is no rate of films"}},
        {"first frame 0",
         render("first_frame = 0"),
         {"11:15: first_frame = 0 is out of range: it must be 1 to 1000000"}},
        {"no picture",
         render("size = [0, 0]"),
         {"11:8: size = [0, 0] is out of range: both must be 1 to 16384"}},
        {"huge picture",
         render("size = [100000, 100000]"),
         {"11:8: size = [100000, 100000] is more than OpenGL can draw: both must be 1 to"}},
        {"half a size",
         render("size = [100]"),
         {"11:8: size must be two whole numbers, such as [1280, 720]"}},
        {"a parameter",
         stage("angle = \"270 deg\""),
         {"9:9: angle = 270 deg is out of range: machine bend takes 0 deg to 180 deg"}},
        {"a parameter's range that hangs on another",
         stage("press = 0.9\nhold = 0.2"),
         {"10:8: hold = 0.2 is out of range: machine bend takes 0 to 0.1"}},
        {"tolerance",
         stage("tolerance = 1"),
         {"9:13: tolerance = 1 is out of range: it must be 0.0001 to 0.1"}},
        {"of the other solver",
         stage("step_safety = 0.5"),
         {"9:15: warning: step_safety has no effect with solver = \"quasistatic\""}},
        {"grips that Euler's steps swing in",
         with(&Parts::stage, "[[stage]]\nmachine = \"stretch\"\nsolver = \"euler\"\n"),
         {"9:10: warning: solver = \"euler\" gains energy wherever nothing damps, as where matter "
          "swings in a grip: a low grip_stiffness of 1 may keep it stable, else use solver = "
          "\"explicit\""}},
        {"a voxel skin divided",
         with(&Parts::rest, "[skin]\nkind = \"boundary\"\ndivide = false\n"),
         {"12:10: warning: divide has no effect with kind = \"boundary\""}},
        {"creases of a voxel skin",
         with(&Parts::rest, "[skin]\nkind = \"boundary\"\ncrease_angle = \"60 deg\"\n"),
         {"12:16: warning: crease_angle has no effect with kind = \"boundary\""}},
        {"a clear film",
         render("background = \"transparent\"\nfilm = true"),
         {"12:8: a film cannot be transparent"}},
        {"no such pass",
         render("passes = [\"depth\", \"mate\"]"),
         {"11:20: passes: \"mate\" is not one of depth, matte, normal, motion, beauty, piece, did "
          "you mean \"matte\"?"}},
        {"a pass alone",
         render("passes = \"depth\""),
         {"11:10: passes must be a list of texts, such as [\"depth\"]"}},
        {"light from below",
         render("light = {elevation = 0}"),
         {"11:22: elevation = 0 deg is out of range: it must be 5 deg to 90 deg"}},
        {"no axis",
         stage("axis = \"xy\""),
         {"9:8: axis = \"xy\" is not one of \"auto\", \"x\", \"y\", \"z\""}},
        {"no way up",
         stage("up = \"+y\""),
         {"9:6: up = \"+y\" is not one of \"auto\", \"x\", \"-x\", \"y\", \"-y\", "
          "\"z\", \"-z\""}},
        {"up along axis",
         stage("axis = \"y\"\nup = \"-y\""),
         {"10:6: up = \"-y\" lies along axis"}},
        {"fov 0",
         render("field_of_view = 0"),
         {"11:17: field_of_view = 0 deg is out of range: it must be between 0 deg and 180 deg"}},
        {"fov 180", render("field_of_view = \"180 deg\""), {"11:17: field_of_view = 180 deg is"}},
        {"camera at its target",
         render("camera = {eye = [1, 2, 3], target = [1, 2, 3]}"),
         {"11:17: eye and target are the same point"}},
        {"eye alone", render("camera = {eye = [1, 2, 3]}"), {"an eye needs a target"}},
        {"eye and zoom",
         render("camera = {eye = [1, 2, 3], target = [0, 0, 0], zoom = 2}"),
         {"eye and target replace azimuth, elevation and zoom: give one set or the other"}},
        {"below ground",
         render("camera = {elevation = \"100 deg\"}"),
         {"11:23: elevation = 100 deg is out of range: it must be -90 deg to 90 deg"}},
        {"two keys at once",
         render("camera = {keys = [{at = 0.5}, {at = 0.5}]}"),
         {"two keys are at 0.5"}},
        {"key without time", render("camera = {keys = [{zoom = 2}]}"), {"needs \"at\""}},
        {"zoom 0", render("camera = {zoom = 0}"), {"zoom = 0 is out of range"}},
    });
    CHECK(mistakes_in(stage("gravity = -0.0\nplace = -0.0").text()) == "");
    CHECK(mistakes_in(stage("angle = \"180 deg\"").text()) == "");  // the end itself is allowed
}

TEST_CASE("an angle of more than a turn draws no word about its unit where it has one") {
    for (const char* text : {"\"450\u00b0\"", "\"450 deg\"", "\"2 turns\"", "\"10 rad\""}) {
        INFO(text);
        const std::string mesh = "[mesh]\nfile = \"bar.obj\"\nturn = [0, %, 0]\n";
        CHECK(mistakes_in(
                  with(&Parts::mesh, std::string(mesh).replace(mesh.find('%'), 1, text)).text())
                  .empty());
    }
}

TEST_CASE("mistakes in loads are found at their place") {
    const auto load = [](const std::string& lines) { return stage("[[stage.load]]\n" + lines); };
    check_all({
        {"nothing", load("on = \"top\""), {"9:1: [[stage.load]] needs \"force\""}},
        {"both",
         load("pressure = 1\nforce = [0, 1, 0]"),
         {"10:12: a load is a force or a pressure"}},
        {"unit",
         load("pressure = \"3 N\""),
         {"10:15: pressure: \"3 N\" is a force; expected a stress"}},
        {"unit of one", load("force = [0, \"2 mm\", 0]"), {"10:16: force: \"2 mm\" is a length"}},
        {"one number", load("force = 3"), {"10:9: force must be three numbers or expressions"}},
        {"a stranger", load("force = [0, \"2*weight\", 0]"), {"10:16: force: "}},
        {"time", load("pressure = \"t\""), {"10:13: pressure: "}},
        {"side", load("pressure = 1\non = \"tpo\""), {"11:6: on = \"tpo\" is not one of"}},
        {"one corner",
         load("pressure = 1\nfrom = [0, 0, 0]"),
         {"11:8: from and to are opposite corners"}},
        {"self-contact in implicit steps",
         stage("solver = \"implicit\"\nself_contact = true"),
         {"10:16: warning: self_contact has no effect with solver = \"implicit\""}},
        {"name",
         load("pressure = 1\nname = \"2\""),
         {"11:8: \"2\" must be letters, digits and _, beginning with a letter"}},
        {"name of a tool",
         load("pressure = 1\nname = \"support\""),
         {"11:8: two parts are called \"support\""}},
        {"misspelt",
         load("presure = 1"),
         {"9:1: [[stage.load]] needs \"force\"", "10:1: unknown key \"presure\""}},
        {"idle gravity",
         stage("gravity_strength = \"t\""),
         {"9:20: warning: gravity_strength has no effect without gravity"}},
        {"gravity sideways",
         stage("gravity = [0, 0, -9.81]"),
         {"9:11: warning: gravity does not point down: y is up"}},
        {"nothing falls",
         with(&Parts::stage, "[[stage]]\nmachine = \"floor\"\n"),
         {"8:11: warning: nothing moves: there is no gravity"}},
        {"nothing happens",
         with(&Parts::stage, "[[stage]]\nmachine = \"hold\"\n"),
         {"8:11: warning: nothing happens: there is no gravity"}},
        {"drag without motion",
         stage("medium_density = 1.2\ndirectional_drag = \"3 Pa s/m\""),
         {"9:18: warning: medium_density has no effect with solver = \"quasistatic\"",
          "10:20: warning: directional_drag has no effect with solver = \"quasistatic\""}},
        {"drag of nothing",
         stage("solver = \"explicit\"\ndrag_coefficient = 2"),
         {"10:20: warning: drag_coefficient has no effect without medium_density"}},
        {"thrust",
         stage("solver = \"explicit\"\nmedium_density = -1"),
         {"10:18: medium_density = -1 kg/m3 is out of range: it must be at least 0"}},
        {"unit of drag",
         stage("solver = \"explicit\"\ndirectional_drag = \"3 Pa\""),
         {"10:23: directional_drag: \"3 Pa\" is a stress; expected a drag"}},
        {"single brackets", stage("[stage.load]\npressure = 1"), {"double brackets"}},
    });
}

TEST_CASE("a huge picture is refused for resources, a missing mesh as a mesh") {
    const SceneFolder scratch;
    const auto code = [&](const Parts& parts) {
        return exit_code(read_scene(scratch.write("s.toml", parts.text()), {}, shipped()).mistakes);
    };
    CHECK(code(Parts()) == ExitCode::done);
    CHECK(code(material("friction = 1e9")) == ExitCode::done);
    CHECK(code(render("size = [100000, 10]")) == ExitCode::resources);
    CHECK(code(with(&Parts::mesh, "[mesh]\nfile = \"no.obj\"\n")) == ExitCode::mesh);
    Parts both = with(&Parts::mesh, "[mesh]\nfile = \"no.obj\"\n");
    both.rest = "[render]\nfps = 0\n";
    CHECK(code(both) == ExitCode::scene);
}

TEST_CASE("names that cannot be found get the known ones, names that cannot be files the reason") {
    const std::string long_name(200, 'a');
    check_all({
        {"machine",
         with(&Parts::stage, "[[stage]]\nmachine = \"bned\"\nangel = 3\n"),
         {"8:11: there is no machine \"bned\", did you mean \"bend\"? Known: bend, carve, core, cut, "}},
        {"no machine",
         with(&Parts::stage, "[[stage]]\nframes = 3\n"),
         {"7:1: [[stage]] needs \"machine\": one of bend, carve, core, cut"}},
        {"machine file",
         with(&Parts::stage, "[[stage]]\nmachine = \"mine/press.toml\"\n"),
         {"8:11: the machine file \"mine/press.toml\" does not exist (/tmp/"}},
        {"material",
         with(&Parts::material, "[material]\nname = \"ruber\"\n"),
         {"4:8: there is no material \"ruber\", did you mean \"rubber\"? Known: "
          "structural_steel"}},
        {"custom without numbers",
         with(&Parts::material, "[material]\nfriction = 0.1\n"),
         {"[material] needs \"young_modulus\"", "3:1: [material] needs \"density\""}},
        {"no mesh", with(&Parts::mesh, "[mesh]\nlength = 1\n"), {"1:1: [mesh] needs \"file\""}},
        {"no section", with(&Parts::mesh, ""), {"s.toml: the section [mesh] is missing"}},
        {"same name",
         with(&Parts::rest, "[[stage]]\nmachine = \"bend\"\nname = \"1-bend\"\n"),
         {"12:8: two stages are called \"1-bend\"; the first is on line 7"}},
        {"slash",
         stage("name = \"a/b\""),
         {"9:8: the name contains \"/\"; it is used in file names"}},
        {"up", stage("name = \"..\""), {"9:8: the name begins with a dot"}},
        {"empty", stage("name = \"\""), {"9:8: the name is empty"}},
        {"blank", stage("name = \" \""), {"9:8: the name begins or ends with a blank"}},
        {"newline", stage("name = \"a\\nb\""), {"9:8: the name contains a control character"}},
        {"long", stage("name = \"" + long_name + "\""), {"9:8: the name is longer than 100 bytes"}},
    });
}

TEST_CASE("a mesh that cannot be read is refused at once, with the path as written and resolved") {
    const SceneFolder scratch;
    std::filesystem::create_directories(scratch.path() / "folder.obj");
    REQUIRE(::mkfifo((scratch.path() / "pipe.obj").c_str(), 0600) == 0);
    const auto mistakes = [&](const std::string& name) {
        const Parts parts = with(&Parts::mesh, "[mesh]\nfile = \"" + name + "\"\n");
        const auto file = scratch.write("scenes/s.toml", parts.text());
        return told(read_scene(file, {}, shipped()).mistakes, scratch.path());
    };
    const std::string folder = scratch.path().string();
    CHECK(mistakes("../no.obj") ==
          "scenes/s.toml:2:8: the mesh \"../no.obj\" does not exist (" + folder + "/no.obj)\n");
    CHECK(mistakes("../folder.obj").find("is a folder, not a file") != std::string::npos);
    CHECK(mistakes("../pipe.obj").find("is not a regular file") != std::string::npos);
    CHECK(mistakes("/dev/zero").find("\"/dev/zero\" is not a regular file (/dev/zero)") !=
          std::string::npos);
    CHECK(mistakes("../bar.obj/x").find("does not exist") != std::string::npos);
    CHECK(mistakes("").find("the mesh's file name is empty") != std::string::npos);
    CHECK(mistakes("../bar.obj") == "");
}

TEST_CASE("a mistake among the materials is told once, however many bodies name one") {
    const SceneFolder scratch;
    scratch.write("materials.toml", "[jelly]\nyoung_modulus = 1e3\ndensity = 1000\ncolour = 3\n");
    std::string text = Parts().text();
    for (const char* name : {"a", "b"}) {
        text += std::string("[[body]]\nname = \"") + name +
                "\"\nfile = \"bar.obj\"\nmaterial = \"jelly\"\n";
    }
    const SceneReading reading = read_scene(scratch.write("s.toml", text), {}, shipped());
    const std::string all = told(reading.mistakes, scratch.path());
    INFO(all);
    const std::size_t first = all.find("unknown key \"colour\"");
    REQUIRE(first != std::string::npos);
    CHECK(all.find("unknown key \"colour\"", first + 1) == std::string::npos);
}
