// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose parts are right one by one and do not go together: refused where the part stands.
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("mistakes in insets are found, and what insets do not go with is refused") {
    const std::string box = "from = [0, 0, 0.5]\nto = [1, 1, 1]\n";
    const auto inset = [](const std::string& lines) {
        return with(&Parts::rest, "[render]\nfps = 30\n[[inset]]\n" + lines);
    };
    Parts springs = inset("name = \"lead\"\n" + box);
    springs.material = "[material]\nname = \"rubber\"\nmechanics = \"springs\"\n";
    Parts undamped = inset("name = \"lead\"\ndamping_ratio = 0\n" + box);
    undamped.stage = "[[stage]]\nmachine = \"bend\"\nsolver = \"euler\"\n";
    check_all({
        {"nowhere",
         inset("name = \"lead\"\n"),
         {"the mesh of the inset; or give a box by from = [0, 0, 0.5] and to = [1, 1, 1], in "
          "fractions of the work-piece's box"}},
        {"empty",
         inset("name = \"lead\"\nfrom = [0, 0, 0.5]\nto = [1, 1, 0.5]\n"),
         {"15:6: the box is empty: from must be less than to"}},
        {"outside",
         inset("name = \"lead\"\nfrom = [0, 0, 0.5]\nto = [1, 1, 2]\n"),
         {"15:6: to = [1, 1, 2]: each must be a fraction of the work-piece's box, 0 to 1"}},
        {"twice",
         inset("name = \"lead\"\nfile = \"bar.obj\"\n" + box),
         {"an inset is a mesh (file) or a box (from, to), not both"}},
        {"of its own restitution",
         inset("name = \"lead\"\nrestitution = 0.3\n" + box),
         {"14:15: restitution applies to the whole body: give it in [material]"}},
        {"of its own friction",
         inset("name = \"lead\"\nfriction = 0.3\n" + box),
         {"14:12: friction applies to the whole body: give it in [material]"}},
        {"in springs",
         springs,
         {"springs allow only one material: use mechanics = \"cells\" in [material]"}},
        {"undamped",
         undamped,
         {"without damping: give each [[inset]] a damping_ratio, or use solver"}},
    });
    Parts remolded = inset("name = \"lead\"\n" + box);
    remolded.stage =
        "[[stage]]\nmachine = \"bend\"\n[[stage]]\nmachine = \"twist\"\nremold = true\n";
    CHECK(mistakes_in(remolded.text()) == "");
}

TEST_CASE("mistakes in probes are found") {
    const auto probe = [](const std::string& lines) {
        return with(&Parts::rest, "[render]\nfps = 30\n[[probe]]\n" + lines);
    };
    const std::string at = "at = [1, 0.5, 0.5]\n";
    CHECK(mistakes_in(probe("name = \"tip\"\n" + at).text()) == "");
    check_all({
        {"nameless", probe(at), {"[[probe]] needs \"name\""}},
        {"nowhere",
         probe("name = \"tip\"\n"),
         {"a place in fractions of the body's box, such as [1, 0.5, 0.5]"}},
        {"outside",
         probe("name = \"tip\"\nat = [1, 0.5, -1]\n"),
         {"14:6: at = [1, 0.5, -1]: each must be a fraction of the body's box, 0 to 1"}},
        {"of no body",
         probe("name = \"tip\"\nbody = \"ball\"\n" + at),
         {"14:8: no body is called \"ball\"; there is work-piece"}},
        {"twice",
         probe("name = \"tip\"\n" + at + "[[probe]]\nname = \"tip\"\n" + at),
         {"16:8: two parts are called \"tip\""}},
        {"as a tool",
         probe("name = \"support\"\n" + at),
         {"\"support\" is a part of a machine, listed in the same table: choose another name"}},
    });
}

TEST_CASE("a block is not molded anew, and no two meshes have one name") {
    Parts block = stage("remold = true");
    block.mold = "[mold]\nacross = 6\nkind = \"block\"\n";
    Parts same;
    same.stage =
        "[[body]]\nname = \"b-c\"\nfile = \"bar.obj\"\nat = [0, 1, 0]\n"
        "[[body]]\nname = \"c\"\nfile = \"bar.obj\"\nat = [0, 2, 0]\n"
        "[[stage]]\nname = \"a\"\nmachine = \"floor\"\ngravity = 9.81\n"
        "[[stage]]\nname = \"a-b\"\nmachine = \"floor\"\ngravity = 9.81\n";
    Parts folder;
    folder.stage =
        "[[stage]]\nname = \"a\"\nmachine = \"bend\"\n[[stage]]\nname = \"a.obj\"\nmachine = "
        "\"bend\"\n[[stage]]\nname = \"a.ob\"\nmachine = \"bend\"\n";
    CHECK(mistakes_in(folder.text()) == "");
    folder.rest += "[output]\nmeshes_per_frame = true\n";
    // Their OBJ and PLY have names of their own.
    Parts library;
    library.stage =
        "[[body]]\nname = \"b 1\"\nfile = \"bar.obj\"\nat = [0, 1, 0]\n"
        "[[body]]\nname = \"b_1\"\nfile = \"bar.obj\"\nat = [0, 2, 0]\n"
        "[[stage]]\nname = \"a\"\nmachine = \"floor\"\ngravity = 9.81\n";
    Parts stages;
    stages.stage =
        "[[stage]]\nname = \"a b\"\nmachine = \"bend\"\n"
        "[[stage]]\nname = \"a#b\"\nmachine = \"bend\"\n";
    check_all({
        {"library",
         library,
         {"body \"b 1\" of stage \"a\" and body \"b_1\" of stage \"a\" would both be written "
          "as a-b_1.mtl: rename one of them"}},
        {"library of stages",
         stages,
         {"stage \"a b\" and stage \"a#b\" would both be written as a_b.mtl"}},
        {"block", block, {"fills the mesh's box, and stage \"1-bend\" would mold the box"}},
        {"folder",
         folder,
         {"stage \"a\" and stage \"a.obj\" would both be written as a.obj: rename one of them"}},
        {"same",
         same,
         {"body \"b-c\" of stage \"a\" and body \"c\" of stage \"a-b\" would both be written "
          "as a-b-c"}},
    });
}

TEST_CASE("a table of bodies in motion and a stage's curves have no file in common") {
    Parts both;
    both.stage =
        "[[stage]]\nname = \"a\"\nmachine = \"floor\"\ngravity = 9.81\n"
        "[[stage]]\nname = \"a-bodies\"\nmachine = \"bend\"\n";
    check_all({{"bodies",
                both,
                {"stage \"a\" and stage \"a-bodies\" would both be written as curves/a-bodies.csv: "
                 "rename one of them"}}});
    both.stage.replace(both.stage.find("floor"), 5, "bend");
    both.stage.erase(both.stage.find("gravity"), 15);
    CHECK(mistakes_in(both.text()) == "");
}

TEST_CASE("numbers that no scene can mean are refused where they stand, with their range") {
    check_all({
        {"gravity",
         stage("gravity = 1e308"),
         {"9:11: gravity = 1e+308 m/s2 is out of range: it must be -1e+09 m/s2 to 1e+09 m/s2"}},
        {"one of three",
         stage("gravity = [0, -9.81, \"1e10 m/s2\"]"),
         {"9:22: gravity = 1e+10 m/s2 is out of range"}},
        {"a far mesh",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\nlength = \"1e300 m\"\n"),
         {"3:10: length = 1e+300 m is out of range: it must be 1 nm to 1e+07 m"}},
        {"no mesh",
         with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\nlength = \"1e-320 m\"\n"),
         {"nm is out of range: it must be 1 nm to 1e+07 m"}},
        {"a parameter",
         stage("angle = \"1e7 turns\""),
         {"9:9: angle = 3.6e+09 deg is out of range"}},
        {"yield", material("yield_stress = 1e16"), {"5:16: yield_stress = 1e+07 GPa is out of"}},
    });
    for (const char* extreme : {"gravity = 1e4", "duration = \"1 us\"", "gravity = [0, 0, -1e6]"}) {
        INFO(extreme);
        CHECK(mistakes_in(stage(extreme).text()).find("out of range") == std::string::npos);
    }
}

TEST_CASE("a mesh of no kind that can be read is refused where it is named") {
    const SceneFolder scratch;
    scratch.write("passwd", "root");
    scratch.write("machines/odd.toml",
                  "[[tool]]\nname = \"ram\"\nshape = \"mesh\"\nlength = 1\nat = [0, 0, 0]\n"
                  "file = \"../passwd\"\n");
    Parts parts = stage("");
    parts.mesh = "[mesh]\nfile = \"passwd\"\n";
    parts.material += "[[inset]]\nname = \"lead\"\nfile = \"s.toml\"\n";
    parts.stage = "[[stage]]\nmachine = \"odd\"\n";
    const auto mistakes = read_scene(scratch.write("s.toml", parts.text()), {}, shipped()).mistakes;
    const std::string text = told(mistakes, scratch.path());
    INFO(text);
    CHECK(exit_code(mistakes) == ExitCode::mesh);
    CHECK(std::count(text.begin(), text.end(), '\n') == 3);
    const std::string kinds = "is not a mesh format that can be read: OBJ, PLY, ";
    CHECK(text.find("s.toml:2:8: the mesh \"passwd\" " + kinds) == 0);
    CHECK(text.find("s.toml:7:8: the mesh \"s.toml\" " + kinds) != std::string::npos);
    CHECK(text.find("machines/odd.toml:6:8: the mesh \"../passwd\" " + kinds) != std::string::npos);
}

TEST_CASE("a solver that cannot move the scene's matter is refused where it is named") {
    const auto solver = [](const std::string& material, const std::string& lines) {
        Parts parts = with(&Parts::stage, "[[stage]]\nmachine = \"bend\"\n" + lines);
        parts.material = "[material]\nname = \"rubber\"\n" + material;
        return parts;
    };
    Parts cracks = with(&Parts::stage, "[[stage]]\nmachine = \"bend\"\nsolver = \"implicit\"\n");
    cracks.material = "[material]\nname = \"ice\"\ndamping_ratio = 0\n";
    check_all({
        {"misspelt", solver("", "solver = \"implcit\"\n"), {"did you mean \"implicit\"?"}},
        {"Euler without damping",
         solver("damping_ratio = 0\n", "solver = \"euler\"\n"),
         {"10:10: solver = \"euler\" gains energy at any step"}},
        {"implicit springs",
         solver("damping_ratio = 0\nmechanics = \"springs\"\n", "solver = \"implicit\"\n"),
         {"11:10: solver = \"implicit\" needs mechanics = \"cells\""}},
        {"implicit cracks", cracks, {"10:10: solver = \"implicit\" does not follow cracks"}},
        {"implicit cuts",
         with(&Parts::stage, "[[stage]]\nmachine = \"cut\"\nsolver = \"implicit\"\n"),
         {"solver = \"implicit\" does not follow cuts, and the machine has a blade"}},
        {"implicit after a cut",
         with(&Parts::stage,
              "[[stage]]\nmachine = \"cut\"\n[[stage]]\nmachine = \"bend\"\nsolver = "
              "\"implicit\"\n"),
         {"cannot move cut matter, which stage \"1-cut\" leaves"}},
        {"implicit drag",
         solver("damping_ratio = 0\n", "solver = \"implicit\"\nmedium_density = 1.2\n"),
         {"11:18: warning: medium_density has no effect with solver = \"implicit\""}},
        {"implicit damping",
         solver("damping_ratio = 0.1\n", "solver = \"implicit\"\n"),
         {"10:10: warning: damping_ratio has no effect with solver = \"implicit\""}},
        {"retries at rest",
         solver("", "retry_limit = 3\n"),
         {"9:15: warning: retry_limit has no effect with solver = \"quasistatic\""}},
        {"retries",
         solver("", "solver = \"explicit\"\nretry_limit = 21\n"),
         {"10:15: retry_limit = 21"}},
    });
}
