// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of several bodies, and of bodies that move from the start.
#include "base/math.h"
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

namespace {

const std::string kSteps = "[[stage]]\nmachine = \"floor\"\ngravity = 9.81\n";

// Lines of the body: 12 and on.
Parts beside(const std::string& lines) {
    Parts parts = with(&Parts::rest, "[render]\nfps = 30\n[[body]]\n" + lines);
    parts.stage = kSteps;
    return parts;
}

}  // namespace

TEST_CASE("a body takes material and mold from the work-piece where it has no own") {
    const SceneFolder scratch;
    Parts parts = beside(R"(file = "bar.obj"
at = ["1 cm", 0, "-2 cm"]
turn = [0, 0, "90 deg"]
velocity = [0, "-3 m/s", 0]
spin = ["30 rpm", 0, 0]
color = [1, 0.5, 0]
finish = "metal"
[[body]]
name = "egg"
file = "bar.obj"
length = "5 cm"
material = "wax"
spacing = "2 mm"
[[body]]
file = "bar.obj"
across = 3
[body.material]
name = "lead"
friction = 0.4
)");
    const SceneReading reading = read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.mistakes.empty());
    const std::vector<BodySpec>& body = reading.scene->body;
    REQUIRE(body.size() == 4);
    CHECK(body[0].name == "work-piece");
    CHECK(body[1].name == "body-2");
    CHECK(body[1].material.name == "rubber");
    CHECK(body[1].mold.across.value() == 6);
    CHECK(body[1].start.at.value() == Vec3(0.01, 0, -0.02));
    CHECK(body[1].start.turn.z() == Approx(kPi / 2));
    CHECK(body[1].start.velocity == Vec3(0, -3, 0));
    CHECK(body[1].start.spin.x() == Approx(kPi));
    CHECK(body[1].color.value().y() == Approx(0.2140).epsilon(1e-3));
    CHECK(body[1].metal.value());
    CHECK(body[2].name == "egg");
    CHECK(body[2].mesh.length.value() == Approx(0.05));
    CHECK(body[2].material.name == "wax");
    CHECK(body[2].mold.spacing.value() == Approx(0.002));
    CHECK_FALSE(body[2].mold.across.has_value());
    CHECK_FALSE(body[2].start.at.has_value());
    CHECK(body[3].material.friction == 0.4);
    CHECK(body[3].mold.across.value() == 3);
}

TEST_CASE("a solver left out is explicit where something is to move, else quasi-static") {
    const SceneFolder scratch;
    const auto solver = [&](const Parts& parts) {
        const SceneReading reading =
            read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return reading.scene->stage[0].sim.solver;
    };
    const std::string bend = "[[stage]]\nmachine = \"bend\"\n";
    CHECK(solver({}) == Solver::quasistatic);
    CHECK(solver(with(&Parts::stage, "[[stage]]\nmachine = \"floor\"\n")) ==
          Solver::explicit_steps);
    Parts several = beside("file = \"bar.obj\"\n");
    several.stage = bend;
    CHECK(solver(several) == Solver::explicit_steps);
    const std::string head = "[mesh]\nfile = \"bar.obj\"\n";
    CHECK(solver(with(&Parts::mesh, head + "spin = [1, 0, 0]\n")) == Solver::explicit_steps);
    CHECK(solver(with(&Parts::mesh, head + "turn = [1, 0, 0]\n")) == Solver::quasistatic);
}

TEST_CASE("mistakes in bodies are found") {
    Parts still = beside("file = \"bar.obj\"\n");
    still.stage = "[[stage]]\nmachine = \"bend\"\nsolver = \"quasistatic\"\n";
    Parts thrown = with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\nvelocity = [1, 0, 0]\n");
    thrown.stage = still.stage;
    check_all({
        {"no mesh",
         beside("name = \"egg\"\n"),
         {"12:1: [[body]] needs \"file\": the mesh of the body"}},
        {"no such mesh", beside("file = \"none.obj\"\n"), {"13:8: the mesh \"none.obj\""}},
        {"a name twice",
         beside("file = \"bar.obj\"\nname = \"work-piece\"\n"),
         {"14:8: two bodies are called \"work-piece\""}},
        {"a name that is no file's",
         beside("file = \"bar.obj\"\nname = \"a/b\"\n"),
         {"14:8: the name contains \"/\""}},
        {"no such material",
         beside("file = \"bar.obj\"\nmaterial = \"waxx\"\n"),
         {"14:12: there is no material \"waxx\", did you mean \"wax\"?"}},
        {"material of another kind",
         beside("file = \"bar.obj\"\nmaterial = 3\n"),
         {"14:12: material must be the name of one, such as \"rubber\", or a section "
          "[body.material]"}},
        {"typo",
         beside("file = \"bar.obj\"\nvelocty = [0, 0, 0]\n"),
         {"did you mean \"velocity\"?"}},
        {"unit",
         beside("file = \"bar.obj\"\nspin = [0, 0, \"3 m\"]\n"),
         {"14:18: spin: \"3 m\" is a length; expected a spin"}},
        {"colour", beside("file = \"bar.obj\"\ncolor = [2, 0, 0]\n"), {"14:9: color = [2, 0, 0]"}},
        {"finish",
         beside("file = \"bar.obj\"\nfinish = \"metal\"\n"),
         {"finish needs a color or a texture beside it"}},
        {"two in equilibrium",
         still,
         {"9:10: solver = \"quasistatic\" computes equilibria and allows"}},
        {"a speed in equilibrium", thrown, {"allows no velocity and no spin"}},
    });
}
