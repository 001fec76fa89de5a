// SPDX-License-Identifier: GPL-3.0-or-later
// What `swage check` foretells of stages, and what a run then keeps of that.
#include <memory>

#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// A bar of 20 cm x 2 cm x 2 cm in these stages; `keys` stand in [mesh].
struct Bar {
    explicit Bar(const std::string& stages, const std::string& material = "rubber",
                 const std::string& keys = {}) {
        swage::write_obj(scratch.path() / "bar.obj",
                         swage::box_mesh({-0.1, -0.01, -0.01}, {0.1, 0.01, 0.01}));
        put_text(scene, "[mesh]\nfile = \"bar.obj\"\n" + keys + "[material]\nname = \"" + material +
                            "\"\n[mold]\nacross = 2\n" + stages);
    }
    Outcome check() const { return run_swage({"check", scene.string()}); }
    Json json() const { return parse_json(run_swage({"check", scene.string(), "--json"}).out); }
    Outcome run() const {
        return run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    }
    Json record() const { return parse_json(bytes_of(out / "run.json")); }

    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", out = scratch.path() / "run";
};

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
        ++count;
    }
    return count;
}
// All that check says.
std::string told_of(const Bar& bar) {
    const Outcome check = bar.check();
    CHECK(check.code == 0);
    return check.err + check.out;
}

const std::string kStretch = "[[stage]]\nmachine = \"stretch\"\nframes = 2\nstrain = ";

}  // namespace

TEST_CASE("a later stage that could not be set up at the body as molded is warned of") {
    const Bar bar(
        kStretch +
        "0.2\n[[stage]]\nmachine = \"hold\"\nframes = 1\n[[stage.load]]\n"
        "force = [0, \"-2 N\", 0]\non = \"top\"\nfrom = [\"20 cm\", \"-1 cm\", \"-1 cm\"]\n"
        "to = [\"30 cm\", \"1 cm\", \"1 cm\"]\n");
    const std::string told = told_of(bar);
    INFO(told);
    CHECK(count_of(told, "load_1 acts on nothing: ") == 1);
    CHECK(says(told, "(stage \"2-hold\", for the work-piece before the first stage)"));
    CHECK(says(json_text(bar.json().at("cost").at("warnings")), "load_1 acts on nothing"));
    const Outcome run = bar.run();
    CHECK(run.code == 3);
    CHECK(says(json_text(bar.record().at("warnings")), "load_1 acts on nothing"));
}

TEST_CASE("what a run has disproved of the warnings of its start is not in its record") {
    const Bar bar(kStretch +
                  "1.5\n[[stage]]\nmachine = \"bend\"\nangle = \"20 deg\"\n"
                  "overhang = \"21 cm\"\nframes = 2\n");
    CHECK(says(told_of(bar), "overhang = 21 cm is out of range"));
    const Outcome run = bar.run();
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK(says(run.err, "overhang = 21 cm is out of range"));
    CHECK(!says(json_text(bar.record().at("warnings")), "out of range"));
}

TEST_CASE("what later machines say of the body as molded is told with their stages, and once") {
    const std::string bend =
        "[[stage]]\nmachine = \"bend\"\nframes = 1\nangle = \"180 deg\"\nradius = \"6 cm\"\n";
    const Bar bar("[[stage]]\nmachine = \"twist\"\nframes = 1\n" + bend + bend);
    const std::string told = told_of(bar);
    INFO(told);
    CHECK(count_of(told, "the work-piece is short for this bend") == 1);
    CHECK(says(told, "2-bend and 3-bend: the work-piece is short for this bend"));
    CHECK(says(json_text(bar.json().at("stages").at(1).at("notes")), "short for this bend"));
}

TEST_CASE("a body that cannot reach the floor in its stage is told how long it would fall") {
    const auto told = [](const std::string& stage, const std::string& keys = {}) {
        return told_of(Bar("[[stage]]\nmachine = \"floor\"\nframes = 2\ndrop = \"2 m\"\n" + stage,
                           "rubber", keys));
    };
    const std::string weight = "gravity = 9.81\n", brief = "duration = \"0.3 s\"\n";
    const std::string falls = told(weight + brief);
    INFO(falls);
    CHECK(says(falls, "falls for 0.639 s before it touches floor, and the stage takes 0.3 s"));
    CHECK(!says(told(weight + "duration = \"0.7 s\"\n"), "before it touches"));
    CHECK(!says(told(weight + brief, "velocity = [0, \"-7 m/s\", 0]\n"), "touch"));
    // What follows it in motion goes on; equilibria leave out how it falls.
    const std::string press = "[[stage]]\nmachine = \"press\"\ndepth = 0.01\nframes = 1\n";
    const std::string left = "2-press, whose equilibria have no speed, leaves out that it still";
    CHECK(says(told(weight + brief + press), "takes 0.3 s; " + left));
    CHECK(!says(told(weight + "duration = \"0.7 s\"\n" + press), left));
    CHECK(!says(told(weight + brief + press + "solver = \"explicit\"\n"), left));
    CHECK(!says(told(brief + press), left));
    CHECK(says(told(weight + brief, "velocity = [0, \"3 m/s\", 0]\n"),
               "falls for 1.01 s before it touches floor"));
    CHECK(says(told(brief, "velocity = [0, \"3 m/s\", 0]\n"),
               "never touches floor: nothing brings it there"));
    CHECK(says(told(brief, "velocity = [\"3 m/s\", 0, 0]\n"), "never touches floor"));
    // Nor along a floor whose normal lies across it but for rounding.
    CHECK(says(told(brief + "axis = \"z\"\n", "velocity = [1, 0, 1]\n"), "never touches floor"));
    CHECK(!says(told(brief, "velocity = [0, \"-7 m/s\", 0]\n"), "touch"));
    // A slope is as near along its normal only, and what rotates may reach down.
    CHECK(!says(told(weight + "duration = \"0.63 s\"\n", "spin = [0, 0, \"9 rad/s\"]\n"), "touch"));
    CHECK(says(told(weight + "slope = \"60 deg\"\nduration = \"0.7 s\"\n"), "falls for 0.903 s"));
    CHECK(!says(told(weight + brief + "[[stage.load]]\nforce = [0, \"-900 N\", 0]\non = \"top\"\n"),
                "touch"));
    // A medium slows what falls, and stops what flies up before gravity would.
    const std::string air = "medium_density = 1.2\n";
    CHECK(says(told(weight + brief + air), "falls for more than 0.639 s before it touches floor"));
    CHECK(says(told(weight + brief + air, "velocity = [0, \"3 m/s\", 0]\n"),
               "falls for more than 0.639 s"));
    // Bodies that fly alike do not meet.
    const auto two = [&](const std::string& spin) {
        return told_of(Bar("[[stage]]\nmachine = \"floor\"\nframes = 2\ndrop = \"2 m\"\n" + weight +
                           brief + "[[body]]\nname = \"other\"\nfile = \"bar.obj\"\n" +
                           "at = [0, \"4 cm\", 0]\n" + spin));
    };
    CHECK(says(two(""), "work-piece falls for 0.639 s before it touches floor"));
    CHECK(!says(two("spin = [0, 0, \"9 rad/s\"]\n"), "before it touches"));
}

TEST_CASE("bodies that press on each other from the start are not told to fly") {
    const auto flies = [](const std::string& at) {
        return says(told_of(Bar("[[stage]]\nmachine = \"floor\"\nframes = 2\ndrop = \"2 m\"\n"
                                "gravity = 9.81\nduration = \"0.3 s\"\n[[body]]\n"
                                "name = \"other\"\nfile = \"bar.obj\"\nat = [0, \"" +
                                at + "\", 0]\n")),
                    "free flight");
    };
    CHECK(flies("2.1 cm"));
    CHECK(!flies("1.95 cm"));
}

TEST_CASE("loads that lift off what nothing holds are told, and a run says that it is lifted off") {
    const auto bar = [](const std::string& force, const std::string& machine = "shelf",
                        const std::string& gravity = "9.81") {
        return Bar("[[stage]]\nmachine = \"" + machine + "\"\ngravity = " + gravity +
                       "\nframes = 4\n[[stage.load]]\non = \"top\"\nforce = " + force + "\n",
                   "structural_steel");
    };
    const Bar lifted = bar("[0, \"50 N\", 0]");
    const std::string told = told_of(lifted);
    INFO(told);
    CHECK(says(told,
               "1-shelf: the loads lift the work-piece with up to 50 N, it weighs 6.16 N, and "
               "nothing holds it down"));
    CHECK(!says(told_of(bar("[0, \"5 N\", 0]")), "nothing holds it down"));
    CHECK(!says(told_of(bar("[0, \"-50 N\", 0]")), "nothing holds it down"));
    CHECK(!says(told_of(bar("[0, \"50 N\", 0]", "hold")), "nothing holds it down"));
    const std::string light = "without gravity nothing presses the work-piece onto what it lies on";
    CHECK(says(told_of(bar("[\"5 N\", 0, 0]", "shelf", "0")), light));
    CHECK(!says(told_of(bar("[0, \"-5 N\", 0]", "shelf", "0")), light));
    CHECK(!says(told_of(bar("[\"5 N\", 0, 0]", "bend", "0")), light));
    const Outcome run = lifted.run();
    INFO(run.err);
    CHECK(run.code == 6);
    CHECK(!says(run.err, "if the matter flows"));
    CHECK(says(run.err, "no tool touches it any more: the loads lift it off"));
}

TEST_CASE("what loads or gravity take off its rests is told of each stage, and only what is so") {
    const auto stage = [](const std::string& load, const std::string& keys) {
        return "[[stage]]\nmachine = \"shelf\"\nframes = 4\n" + keys +
               (load.empty() ? "" : "[[stage.load]]\n" + load);
    };
    const auto bar = [&](const std::string& load, const std::string& keys,
                         const std::string& material = "structural_steel") {
        return told_of(Bar(stage(load, keys), material));
    };
    const std::string weight = "gravity = 9.81\n";
    // Of 6.16 N; the rests lie 18 cm apart, the end 19 cm from the farther one.
    const auto at_end = [](const std::string& up) {
        return "on = \"right\"\nforce = [0, \"" + up + "\", 0]\n";
    };
    const std::string tipped =
        "the loads tip the work-piece as it lies on left and right, and too little";
    CHECK(says(bar(at_end("4 N"), weight), tipped));
    CHECK(!says(bar(at_end("2 N"), weight), "tip the work-piece"));
    CHECK(says(bar(at_end("-300 N"), weight), tipped));
    CHECK(!says(bar(at_end("-40 N"), weight), "tip the work-piece"));
    // What is as soft as this lifts an end and stays.
    CHECK(!says(bar(at_end("0.45 N"), weight, "rubber"), "tip the work-piece"));

    CHECK(says(bar("", "gravity = [0, 9.81, 0]\n"), "gravity presses the work-piece onto no tool"));
    CHECK(says(bar("", "gravity = [9.81, 0, 0]\n"), "gravity presses the work-piece onto no tool"));
    CHECK(!says(bar("", weight), "onto no tool"));
    const std::string top = "on = \"top\"\nforce = [0, \"5 N\", 0]\nstrength = \"1\"\n";
    CHECK(says(bar(top, weight + "gravity_strength = \"t\"\n"),
               "the loads lift the work-piece with 5 N at 33.3 ms, it weighs 1.54 N then"));
    CHECK(!says(bar(top, weight + "gravity_strength = \"ramp(t, 0, 0.25)\"\n"), "lift"));
    // Later stages too, if nothing was cut or thrown before.
    const std::string lifts = stage("on = \"top\"\nforce = [0, \"50 N\", 0]\n", weight);
    const std::string second = "2-shelf: the loads lift the work-piece";
    CHECK(says(told_of(Bar(stage("", weight) + lifts, "structural_steel")), second));
    CHECK(!says(
        told_of(Bar("[[stage]]\nmachine = \"cut\"\nframes = 2\n" + lifts, "structural_steel")),
        second));
}

TEST_CASE("a later stage that another longest side would refuse is told what keeps its axis") {
    const auto bent = [](const std::string& keys) {
        return told_of(Bar(kStretch + "0.01\n[[stage]]\nmachine = \"bend\"\nframes = 1\n" + keys));
    };
    const std::string keeps = "lie along up = \"z\"; axis = \"x\" keeps it";
    CHECK(says(bent("up = \"z\"\n"), keeps));
    CHECK(!says(bent("up = \"z\"\naxis = \"x\"\n"), "keeps it"));
    CHECK(!says(bent(""), "keeps it"));
}

TEST_CASE("what goes off where grips leave it free is told with the way, and a run stops at once") {
    const auto bar = [](const std::string& along, const std::string& keys) {
        auto made = std::make_unique<Bar>("[[stage]]\nmachine = \"guide\"\nframes = 2\n" + keys);
        fs::create_directory(made->scratch.path() / "machines");
        put_text(made->scratch.path() / "machines/guide.toml",
                 "help = \"a guide\"\n[[grip]]\nname = \"guide\"\nalong = \"" + along +
                     "\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
                     "to = [\"length\", \"-0.4*height\", \"width\"]\n");
        return made;
    };
    const auto pull = [](const std::string& force) {
        return "[[stage.load]]\non = \"right\"\nforce = " + force + "\n";
    };
    const std::string weight = "gravity = 9.81\n", off = "which its grips leave free";
    const auto slides = bar("yz", weight + pull("[\"-2 N\", 0, 0]"));
    CHECK(says(told_of(*slides),
               "1-guide: loads and gravity push the work-piece with up to 2 N "
               "along the world's -x, which its grips leave free"));
    const Outcome run = slides->run();
    INFO(run.err);
    CHECK(run.code == 6);
    CHECK(says(run.err, "the work-piece goes off at"));
    CHECK(says(run.err, "along the world's -x, which its grips leave free"));
    CHECK(!says(run.err, "halvings"));
    CHECK(says(told_of(*bar("xz", weight)),
               "gravity pulls the work-piece with up to 730 mN along "
               "the world's -y, which its grips leave free"));
    for (const auto& held : {bar("xyz", weight + pull("[\"2 N\", 0, 0]")), bar("y", weight),
                             bar("yz", weight + pull("[0, \"1 N\", \"1 N\"]")),
                             bar("xy", pull("[\"1 N\", \"1 N\", 0]"))}) {
        CHECK(!says(told_of(*held), "free"));
        CHECK(held->run().code == 0);
    }
    // A turn comes to an end, or not.
    CHECK(says(told_of(*bar("y", pull("[0, 0, \"1 N\"]"))), "along the world's z, " + off));
    const std::string couple =
        "[[stage.load]]\non = \"front\"\nforce = [0, 0, \"-1 N\"]\n"
        "from = [0, \"-1 cm\", \"-1 cm\"]\nto = [\"10 cm\", \"1 cm\", \"1 cm\"]\n"
        "[[stage.load]]\non = \"back\"\nforce = [0, 0, \"1 N\"]\n"
        "from = [\"-10 cm\", \"-1 cm\", \"-1 cm\"]\nto = [0, \"1 cm\", \"1 cm\"]\n";
    CHECK(says(told_of(*bar("y", couple)),
               "the loads push the work-piece round the world's y, and its grips leave it free"));
    CHECK(!says(told_of(*bar("yz", couple)), "free"));
}

TEST_CASE("what friction does not hold on its rests is told with the way") {
    const auto told = [](const std::string& force, const std::string& friction,
                         const std::string& wall = {}) {
        Bar bar(
            "[[stage]]\nmachine = \"table\"\nframes = 2\ngravity = 9.81\n[[stage.load]]\n"
            "on = \"top\"\nforce = " +
            force + "\n");
        fs::create_directory(bar.scratch.path() / "machines");
        put_text(bar.scratch.path() / "machines/table.toml",
                 "help = \"a table\"\nupright = true\n[[tool]]\nname = \"table\"\nshape = \"box\"\n"
                 "size = [\"9*length\", \"height\", \"9*length\"]\nat = [0, \"-height\", 0]\n"
                 "touch = [0, 1, 0]\nfriction = " +
                     friction + "\n" + wall);
        return told_of(bar);
    };
    // It weighs 0.73 N.
    const std::string smooth = "loads and gravity push the work-piece along the world's ";
    CHECK(says(told("[\"1 N\", 0, 0]", "0"), smooth + "x by more than table bears there"));
    CHECK(says(told("[0, 0, \"-1 N\"]", "0.3"), smooth + "-z by more than table"));
    CHECK(!says(told("[0, 0, \"-1 N\"]", "2"), smooth));
    CHECK(!says(told("[0, \"-1 N\", 0]", "0"), smooth));
    // Something stands in its way, however far.
    const std::string wall =
        "[[tool]]\nname = \"wall\"\nshape = \"box\"\n"
        "size = [\"height\", \"9*height\", \"9*width\"]\n"
        "at = [\"length\", 0, 0]\nfriction = 0\n";
    CHECK(!says(told("[\"1 N\", 0, 0]", "0", wall), smooth));
    CHECK(says(told("[\"-1 N\", 0, 0]", "0", wall), smooth + "-x"));
}
