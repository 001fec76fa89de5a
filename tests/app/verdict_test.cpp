// SPDX-License-Identifier: GPL-3.0-or-later
// What a run says of a stage that did not do what was meant.
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using swage::test::box_mesh;
using swage::test::together;

namespace {

// What a run of this body in these stages says; `keys` stand in [mesh].
std::string told_of(const swage::TriMesh& mesh, const std::string& stages,
                    const std::string& keys = {}, const std::string& material = "rubber",
                    int across = 2) {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml";
    swage::write_obj(scratch.path() / "body.obj", mesh);
    put_text(scene, "[mesh]\nfile = \"body.obj\"\n" + keys + "[material]\nname = \"" + material +
                        "\"\n[mold]\nacross = " + std::to_string(across) + "\n" + stages);
    const Outcome outcome = run_swage(
        {"run", scene.string(), "--out", (scratch.path() / "run").string(), "--no-render"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return outcome.err;
}

const swage::TriMesh kBar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});

}  // namespace

TEST_CASE("a blade that meets nothing is told of, and one that cuts is not") {
    const swage::TriMesh parted = together(box_mesh({-0.05, -0.01, -0.01}, {-0.02, 0.01, 0.01}),
                                           box_mesh({0.02, -0.01, -0.01}, {0.05, 0.01, 0.01}));
    const std::string cut = "[[stage]]\nmachine = \"cut\"\nframes = 2\n";
    CHECK(says(told_of(parted, cut), "met no matter"));
    CHECK(!says(told_of(kBar, cut), "met no matter"));
}

TEST_CASE("a blade that passes between the particles of a cell is not said to have met no matter") {
    const swage::TriMesh bar = box_mesh({-0.06, -0.01, -0.01}, {0.06, 0.01, 0.01});
    const auto told = [&](const std::string& width) {
        return told_of(bar, "[[stage]]\nmachine = \"cut\"\nframes = 2\n" + width, {}, "rubber", 3);
    };
    const std::string narrow = told("blade_width = \"4 mm\"\n");
    INFO(narrow);
    CHECK(says(narrow,
               "the blade went into matter but severed nothing: what is narrower than a "
               "cell, 6.667 mm, "));
    CHECK(!says(narrow, "met no matter"));
    CHECK(!says(told(""), "severed nothing"));
}

TEST_CASE("of a blade that stands while a body flies through it that is said, not that it missed") {
    const Scratch scratch;
    fs::create_directory(scratch.path() / "machines");
    put_text(scratch.path() / "machines/edge.toml",
             "help = \"a blade that stands\"\n[[blade]]\nname = \"blade\"\n"
             "edge = [[\"0.6*length\", \"height\", 0], [\"0.6*length\", \"-height\", 0]]\n");
    swage::write_obj(scratch.path() / "body.obj", kBar);
    put_text(scratch.path() / "scene.toml",
             "[mesh]\nfile = \"body.obj\"\nvelocity = [2, 0, 0]\n[material]\nname = \"rubber\"\n"
             "[mold]\nacross = 2\n[[stage]]\nmachine = \"edge\"\nframes = 2\n"
             "solver = \"explicit\"\nduration = \"50 ms\"\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--out", "run", "--no-render"}, scratch.path());
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(says(outcome.err, "blades cut only by their own motion, and this one stands still"));
    CHECK(!says(outcome.err, "met no matter"));
}

TEST_CASE("what flies against a slow blade is cut; what grips carry past it uncut is told of") {
    const auto told = [](const std::string& grip, const std::string& keys) {
        const Scratch scratch;
        fs::create_directory(scratch.path() / "machines");
        put_text(scratch.path() / "machines/slow.toml",
                 "help = \"a slow blade\"\n[[blade]]\nname = \"blade\"\n"
                 "edge = [[0, \"1.5*height\", \"-width\"], [0, \"1.5*height\", \"width\"]]\n"
                 "[blade.motion]\nmove = [0, \"-0.1*height*t\", 0]\n" +
                     grip);
        swage::write_obj(scratch.path() / "body.obj", kBar);
        put_text(scratch.path() / "scene.toml",
                 "[mesh]\nfile = \"body.obj\"\n" + keys +
                     "[material]\nname = \"rubber\"\n[mold]\nacross = 2\n[[stage]]\n"
                     "machine = \"slow\"\nframes = 40\nsolver = \"explicit\"\n"
                     "duration = \"10 ms\"\n");
        const Outcome outcome =
            run_swage({"run", "scene.toml", "--out", "run", "--no-render"}, scratch.path());
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return outcome.err;
    };
    const std::string flown = told("", "velocity = [0, 8, 0]\n");
    INFO(flown);
    CHECK(!says(flown, "sever"));
    CHECK(!says(flown, "met no matter"));
    const std::string carried = told(
        "[[grip]]\nname = \"all\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
        "to = [\"length\", \"height\", \"width\"]\n[grip.motion]\n"
        "move = [0, \"4*height*t\", 0]\n",
        {});
    INFO(carried);
    CHECK(says(carried, " passed the edge uncut, as the body itself moved them past it"));
    CHECK(!says(carried, "owing to its place"));
    CHECK(!says(carried, "met no matter"));
}

TEST_CASE("what grips carry past a blade that has cut a part of it is told of") {
    const Scratch scratch;
    fs::create_directory(scratch.path() / "machines");
    put_text(scratch.path() / "machines/part.toml",
             "help = \"a blade that goes in\"\n[[blade]]\nname = \"blade\"\n"
             "edge = [[0.001, \"0.51*height\", \"-width\"], [0.001, \"0.51*height\", \"width\"]]\n"
             "[blade.motion]\nmove = [0, \"-0.4*height*t\", 0]\n"
             "[[grip]]\nname = \"all\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
             "to = [\"length\", \"height\", \"width\"]\n[grip.motion]\n"
             "move = [0, \"4*height*line(t, 0.5, 1)\", 0]\n");
    swage::write_obj(scratch.path() / "body.obj", kBar);
    put_text(scratch.path() / "scene.toml",
             "[mesh]\nfile = \"body.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 6\n"
             "[[stage]]\nmachine = \"part\"\nframes = 40\nsolver = \"explicit\"\n"
             "duration = \"10 ms\"\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--out", "run", "--no-render"}, scratch.path());
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(says(outcome.err, " connections but separated nothing: "));
    CHECK(says(outcome.err, " others passed the edge uncut, as the body itself moved them past"));
}

TEST_CASE("a blade is said to have gone into what was there when it passed, not what came later") {
    // It falls beyond the bar's end; then the bar is drawn to where it was.
    const auto told = [&](const char* place) {
        const Scratch scratch;
        fs::create_directory(scratch.path() / "machines");
        put_text(scratch.path() / "machines/beside.toml",
                 std::string("help = \"a blade beside what is drawn under it\"\n") +
                     "[[grip]]\nname = \"hold\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
                     "to = [\"-0.4*length\", \"height\", \"width\"]\n"
                     "[[grip]]\nname = \"draw\"\nfrom = [\"0.4*length\", \"-height\", \"-width\"]\n"
                     "to = [\"length\", \"height\", \"width\"]\n[grip.motion]\n"
                     "move = [\"0.2*length*ramp(t, 0.6, 1)\", 0, 0]\n[[blade]]\nname = \"blade\"\n"
                     "edge = [[\"" +
                     place + "\", \"2*height\", \"-0.02*width\"], [\"" + place +
                     "\", \"2*height\", \"0.02*width\"]]\n[blade.motion]\n"
                     "move = [0, \"-4*height*ramp(t, 0, 0.5)\", 0]\n");
        swage::write_obj(scratch.path() / "body.obj", kBar);
        put_text(scratch.path() / "scene.toml",
                 "[mesh]\nfile = \"body.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 3\n"
                 "[[stage]]\nmachine = \"beside\"\nframes = 4\n");
        const Outcome outcome =
            run_swage({"run", "scene.toml", "--out", "run", "--no-render"}, scratch.path());
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return outcome.err;
    };
    for (const char* place : {"0.501*length", "0.55*length"}) {
        CAPTURE(place);
        CHECK(says(told(place), "the blade met no matter"));
    }
    // This one passes between the particles of what is there.
    CHECK(says(told("0.11*length"), "the blade went into matter but severed nothing"));
}

TEST_CASE("blades that cut nothing, grips that hold nothing and pieces in no grip are told of") {
    const auto sliced = [](const char* slices, int across) {
        return told_of(
            kBar,
            std::string("[[stage]]\nmachine = \"slice\"\nframes = 2\nslices = ") + slices + "\n",
            {}, "rubber", across);
    };
    // Ten layers of cells: of the 13 blades three fall where another does, and no slice has a cell.
    const std::string thin = sliced("14", 2);
    INFO(thin);
    CHECK(says(thin, "blade_4, blade_8 and blade_11 cut nothing: "));
    CHECK(says(thin, "slice_1, slice_2, slice_3 and 11 others hold nothing: "));
    CHECK(says(thin, " are in no grip: "));
    const std::string thick = sliced("3", 4);
    INFO(thick);
    for (const char* what : {"cut nothing", "hold nothing", "in no grip"}) {
        CHECK(!says(thick, what));
    }
}

TEST_CASE("no more energy is said to be lost than a body began with and was given") {
    const std::string told = told_of(
        kBar,
        "[[stage]]\nmachine = \"floor\"\ndrop = \"20 cm\"\nframes = 20\nduration = \"10 s\"\n"
        "solver = \"implicit\"\n",
        "spin = [0, 0, \"60 rad/s\"]\n");
    INFO(told);
    const std::size_t share = told.find("do not close: ");
    REQUIRE(share != std::string::npos);
    CHECK(std::stod(told.substr(share + 14)) > 50);
    CHECK(std::stod(told.substr(share + 14)) <= 100);
}

TEST_CASE("a block in layers stays between smooth plates, and is not said to buckle") {
    const Scratch scratch;
    swage::write_obj(scratch.path() / "body.obj",
                     box_mesh({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}));
    put_text(scratch.path() / "scene.toml",
             "[mesh]\nfile = \"body.obj\"\n[material]\nyoung_modulus = 1e8\npoisson_ratio = 0.3\n"
             "density = 1000\n[[inset]]\nfrom = [0, 0, 0]\nto = [0.4, 1, 1]\nyoung_modulus = 1e6\n"
             "poisson_ratio = 0.3\ndensity = 1000\n[mold]\nacross = 4\n[[stage]]\n"
             "machine = \"press\"\ndepth = 0.15\npress = 1\nrelease = 0\nframes = 15\n"
             "friction = 0\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--out", "run", "--no-render"}, scratch.path());
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(!says(outcome.err, "slipped away"));
    CHECK(!says(outcome.err, "buckled"));
}

TEST_CASE("books that loads alone leave open are not laid at tools") {
    const swage::TriMesh rod = box_mesh({-0.1, -0.01, -0.01}, {0.1, 0.01, 0.01});
    const std::string told =
        told_of(rod,
                "[[stage]]\nmachine = \"hold\"\nframes = 1\n[[stage.load]]\non = \"top\"\n"
                "pressure = \"24 kPa\"\n");
    INFO(told);
    CHECK(says(told, "the work of loads is inaccurate between frames that are far apart"));
}

TEST_CASE("pieces that have fallen into each other are told of, and those that met are not") {
    const swage::TriMesh pile = together(box_mesh({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}),
                                         box_mesh({-0.01, 0.04, -0.01}, {0.01, 0.06, 0.01}));
    const std::string fall =
        "[[stage]]\nmachine = \"floor\"\ngravity = \"9.81 m/s2\"\nframes = 2\n"
        "drop = \"2 mm\"\nduration = \"90 ms\"\n";
    const std::string told = told_of(pile, fall);
    CHECK(says(told, "pieces of the work-piece overlap each other, by "));
    CHECK(says(told, "self_contact = true in this stage prevents that"));
    CHECK(!says(told_of(pile, fall + "self_contact = true\n"), "overlap each other"));
}

TEST_CASE("a body in one piece that has sunk into itself in motion is told of") {
    // A hairpin on its side, the upper arm of which sags through the lower.
    const swage::TriMesh hairpin = together(together(box_mesh({0, 0, 0}, {0.12, 0.01, 0.01}),
                                                     box_mesh({0, 0.02, 0}, {0.12, 0.03, 0.01})),
                                            box_mesh({0, 0, 0}, {0.01, 0.03, 0.01}));
    const std::string sag =
        "[[stage]]\nmachine = \"floor\"\ngravity = \"60 m/s2\"\nframes = 2\n"
        "drop = \"0.1 mm\"\nduration = \"60 ms\"\n";
    const std::string told = told_of(hairpin, sag);
    INFO(told);
    CHECK(says(told, "the work-piece has passed into itself, by "));
    CHECK(says(told, "self_contact = true in this stage prevents that"));
    CHECK(!says(told_of(hairpin, sag + "self_contact = true\n"), "passed into itself"));
    CHECK(!says(told_of(kBar, sag), "passed into itself"));
}

TEST_CASE("pieces that are pressed into each other at rest are told of") {
    const std::string cut = "[[stage]]\nmachine = \"cut\"\nframes = 2\npart = 0.02\n";
    const std::string press =
        "[[stage]]\nmachine = \"press\"\naxis = \"y\"\nup = \"x\"\ndepth = 0.4\npress = 1\n"
        "release = 0\nframes = 3\n";
    CHECK(!says(told_of(kBar, cut), "overlap each other"));
    const std::string told = told_of(kBar, cut + press, {}, "rubber", 4);
    INFO(told);
    CHECK(says(told, "2-press: pieces of the work-piece overlap each other, by "));
    CHECK(says(told, "self_contact = true in this stage prevents that"));
}

TEST_CASE("tools are said to have touched nothing only where that is known") {
    const std::string apart =
        "[[stage]]\nmachine = \"floor\"\ndrop = \"20 cm\"\nframes = 2\nduration = \"1 ms\"\n"
        "solver = \"explicit\"\ngravity = 9.81\n";
    CHECK(says(told_of(kBar, apart), "its tools never touched the work-piece"));
    // The plate turns the bar, which nothing holds, out of its way: no force is left between them.
    const std::string press =
        "[[stage]]\nmachine = \"press\"\ndepth = 0.1\npress = 1\nrelease = 0\nframes = 4\n";
    const std::string told = told_of(kBar, press, "turn = [0, 0, \"30 deg\"]\n");
    INFO(told);
    CHECK(!says(told, "never touched"));
    CHECK(says(
        told,
        "none of its tools presses on the work-piece at the end of any frame: none reached it, "
        "or they separated within a frame, as happens where nothing holds it"));
    CHECK(!says(told_of(kBar, press), "its tools"));
}

TEST_CASE("a cut through matter at rest is said to have made no energy") {
    const std::string material = GENERATE("copper", "structural_steel", "rubber");
    for (const char* frames : {"8", "9", "12"}) {
        const std::string told =
            told_of(kBar, std::string("[[stage]]\nmachine = \"cut\"\nframes = ") + frames + "\n",
                    {}, material);
        INFO(material << ", " << frames << " frames: " << told);
        CHECK(!says(told, "books do not close"));
    }
}

TEST_CASE("what starts pressed into the floor, or another body, is said to be thrown off, once") {
    const auto beside = [](const std::string& at) {
        return told_of(kBar,
                       "[[body]]\nname = \"other\"\nfile = \"body.obj\"\nacross = 2\nat = " + at +
                           "\n[[stage]]\nmachine = \"floor\"\ndrop = 0\nframes = 2\n"
                           "duration = \"20 ms\"\ngravity = 9.81\n");
    };
    const std::string thrown = "starts pressed into what it touches, which throws it off";
    CHECK(says(beside("[0.2, -0.0004, 0]"), "other " + thrown));
    const std::string both = beside("[0.0, 0.0196, 0]");
    CHECK(says(both, thrown));
    CHECK(says(both, "move it further away with `at`"));
    CHECK(says(both, ", as does 1 other body: "));
    CHECK(!says(both, "deep in"));
    // What is told to lie deep in something is not told again.
    const std::string deep = beside("[0.0, 0.019, 0]"), sunk = beside("[0.2, -0.001, 0]");
    CHECK(says(deep, "start 1 mm deep in each other"));
    CHECK(!says(deep, thrown));
    CHECK(says(sunk, "\"other\" starts 1 mm deep in tool floor"));
    CHECK(!says(sunk, thrown));
    CHECK(!says(beside("[0.2, 0, 0]"), thrown));
    CHECK(!says(beside("[0.0, 0.02, 0]"), thrown));
    CHECK(!says(beside("[0.2, -0.00001, 0]"), thrown));
    // In a later stage, too.
    const std::string later =
        told_of(kBar,
                "[[body]]\nname = \"other\"\nfile = \"body.obj\"\nacross = 2\n"
                "at = [0.2, -0.005, 0]\n"
                "[[stage]]\nmachine = \"floor\"\ndrop = 0.01\nframes = 2\nduration = \"1 ms\"\n"
                "[[stage]]\nmachine = \"floor\"\ndrop = 0\nframes = 2\nduration = \"1 ms\"\n"
                "gravity = 9.81\n");
    INFO(later);
    CHECK(says(later, "2-floor: \"other\" starts 5 mm deep in tool floor"));
    CHECK(!says(later, thrown));
}

TEST_CASE("what was pressed and came back is not said to have made energy by what little is left") {
    const swage::TriMesh cube = box_mesh({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05});
    const std::string told =
        told_of(cube, "[[stage]]\nmachine = \"press\"\ndepth = 0.3\nfriction = 0\nframes = 20\n");
    INFO(told);
    CHECK(!says(told, "books do not close"));
}

TEST_CASE("glass that goes to pieces at once gets a skin") {
    // Of its broken faces some are filled from a place that their outlines have made another.
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", run = scratch.path() / "run";
    REQUIRE(run_swage({"make", "tube", "--out", (scratch.path() / "tube.obj").string()}).code == 0);
    put_text(scene, R"([mesh]
file = "tube.obj"
velocity = [0, -42, 0]
[material]
name = "glass"
[mold]
across = 4
[[stage]]
machine = "floor"
drop = "1 mm"
frames = 2
duration = "0.291 ms"
)");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render"});
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(fs::exists(run / "meshes/1-floor.obj"));
}

TEST_CASE("cracked cells that are turned inside out at rest are told of") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "scene.toml", run = scratch.path() / "run";
    swage::write_obj(scratch.path() / "cube.obj",
                     box_mesh({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}));
    put_text(scene, R"([mesh]
file = "cube.obj"
[material]
young_modulus = 1e6
poisson_ratio = 0.3
density = 1000
[[inset]]
from = [0.1, 0.17, 0.13]
to = [0.77, 0.71, 0.83]
young_modulus = 1e7
poisson_ratio = 0.2
density = 1000
strength = 3e5
toughness = 20
[mold]
across = 4
[[stage]]
machine = "press"
press = 1
release = 0
frames = 24
)");
    const auto told = [&](const char* depth) {
        const Outcome outcome =
            run_swage({"run", scene.string(), "--no-render", "--out", run.string(), "--fresh",
                       "--set", std::string("stage.1.depth=") + depth});
        CHECK(outcome.code == 0);
        return outcome.err;
    };
    CHECK(!says(told("0.15"), "inside out"));  // its core has cracked
    const std::string crushed = told("0.3");
    INFO(crushed);
    CHECK(says(crushed, "cells of the work-piece that had cracked were pressed until inside out"));
}

TEST_CASE("equilibria after motion tell what of that they leave out") {
    const auto told = [](const std::string& duration) {
        return told_of(kBar,
                       "[[stage]]\nmachine = \"floor\"\ndrop = \"5 cm\"\ngravity = 9.81\n"
                       "frames = 2\nduration = " +
                           duration +
                           "\n[[stage]]\nmachine = \"press\"\nsolver = \"quasistatic\"\n"
                           "depth = 0.01\nframes = 1\n");
    };
    const std::string falling = told("\"50 ms\"");
    INFO(falling);
    CHECK(says(falling, "2-press: it begins in motion, at up to 490.5 mm/s, which equilibria "));
    CHECK(says(falling, "J of kinetic energy are left out"));
    CHECK(!says(told("\"2 s\""), "begins in motion"));
}

TEST_CASE(
    "bodies that lie in each other after they met are told of, once, and that touch are not") {
    const auto told = [](const std::string& speed) {
        const Scratch scratch;
        swage::write_obj(scratch.path() / "b.obj",
                         box_mesh({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}));
        const std::string stage =
            "[[stage]]\nmachine = \"floor\"\ndrop = 0\ngravity = 0\nframes = ";
        put_text(scratch.path() / "s.toml",
                 "[mesh]\nfile = \"b.obj\"\nat = [0, 0.05, 0]\n[material]\nyoung_modulus = 1e6\n"
                 "poisson_ratio = 0.3\ndensity = 1000\ndamping_ratio = 0.1\nrestitution = 0.3\n"
                 "[mold]\nacross = 3\n[[body]]\nname = \"hit\"\nfile = \"b.obj\"\n"
                 "at = [0.01, 0.22, 0.005]\nturn = [0.1, 0.2, 0.3]\nvelocity = [0, -" +
                     speed + ", 0]\n" + stage + "40\nduration = 0.4\nstep_safety = 0.8\n" + stage +
                     "2\nduration = 0.01\nstep_safety = 0.8\n");
        const Outcome outcome =
            run_swage({"run", "s.toml", "--out", "run", "--no-render"}, scratch.path());
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return outcome.err;
    };
    const std::string fast = told("25");
    INFO(fast);
    CHECK(says(fast, "1-floor: work-piece and hit lie "));
    CHECK(says(fast, " deep in each other at the end: they met faster"));
    CHECK(!says(fast, "2-floor: work-piece and hit lie "));
    CHECK(!says(told("2"), "deep in each other"));
}
