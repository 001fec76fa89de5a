// SPDX-License-Identifier: GPL-3.0-or-later
#include <ctime>

#include "base/units.h"
#include "scene/catalogue.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"

using namespace swage;
using namespace swage::test;

namespace {

const char* kSample = R"(
[mesh]
file = "../meshes/calf.obj"
length = "40 cm"              # scales the longest side of the box
[material]
name = "rubber"               # any field may be given or overridden
yield_stress = "0.3 MPa"
[mold]
across = 6
[skin]
kind = "mount"
[[stage]]
machine = "bend"
angle = "60 deg"
frames = 60
[render]
size = [1280, 720]
)";

SceneReading read(const SceneFolder& scratch, const std::string& text,
                  const std::vector<std::string>& overrides = {}) {
    return read_scene(scratch.write("scene.toml", text), overrides, shipped());
}

const std::string kHead = "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"rubber\"\n";

}  // namespace

TEST_CASE("the sample scene reads whole, in SI") {
    const SceneFolder scratch;
    scratch.write("meshes/calf.obj", "v 0 0 0\n");
    const auto file = scratch.write("scenes/sample.toml", kSample);
    const SceneReading reading = read_scene(file, {}, shipped());
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.mistakes.empty());
    REQUIRE(reading.scene);
    const SceneSpec& scene = *reading.scene;
    CHECK(scene.name == "sample");
    CHECK(scene.file == file);
    CHECK(scene.work_piece().mesh.file == scratch.path() / "meshes/calf.obj");
    CHECK(scene.work_piece().mesh.length.value() == Approx(0.4));
    CHECK(scene.work_piece().material.name == "rubber");
    CHECK(scene.work_piece().material.young_modulus == Approx(2e6));
    CHECK(scene.work_piece().material.yield_stress == Approx(3e5));
    CHECK(scene.work_piece().mold.across.value() == 6);
    CHECK_FALSE(scene.work_piece().mold.spacing.has_value());
    CHECK(scene.skin.kind == SkinKind::mount);
    REQUIRE(scene.stage.size() == 1);
    CHECK(scene.stage[0].name == "1-bend");
    CHECK(scene.stage[0].machine.name == "bend");
    CHECK(scene.stage[0].parameter.at("angle") == Approx(kPi / 3));
    CHECK(scene.stage[0].parameter.size() == 1);
    CHECK(scene.stage[0].frames == 60);
    CHECK(scene.stage[0].duration == 60 / scene.render.frame_rate.value());
    CHECK(scene.render.width == 1280);
    CHECK(scene.render.height == 720);
    const std::filesystem::path source = SWAGE_SOURCE_DIR;
    CHECK(scene.inputs == std::vector<std::filesystem::path>{file, source / "assets/materials.toml",
                                                             source / "machines/bend.toml"});
}

TEST_CASE("every key of a scene reaches its setting") {
    const SceneFolder scratch;
    const SceneReading reading = read(scratch, R"(
[mesh]
file = "bar.obj"
[material]
young_modulus = "1 GPa"
poisson_ratio = 0.25
density = "1.2 g/cm3"
yield_stress = "3 MPa"
hardening = "1 MPa"
strength = "4 MPa"
toughness = "2 kJ/m^2"
damping_ratio = 0.1
friction = 0.4
static_friction = 0.5
restitution = 0.3
stickiness = "2 kPa"
[mold]
spacing = "5 mm"
kind = "block"
cell_limit = 1000
[skin]
kind = "boundary"
[[stage]]
machine = "twist"
name = "wring it"
frames = 7
duration = "2 s"
axis = "z"
up = "-x"
remold = false
solver = "quasistatic"
tolerance = 1e-3
iteration_limit = 900
halving_limit = 2
contact_stiffness = 3
grip_stiffness = 30
self_contact = true
gravity = "9.81 m/s2"
gravity_strength = "0.5 + t*duration/4"
angle = "-0.5 turn"
[[stage.load]]
name = "books"
force = [0, "-20 N", "0.1*length"]
on = "top"
from = ["-length/4", "-height", "-3 cm"]
to = ["length/4", "height", "3 cm"]
strength = "angle < 0 ? t : 0"
[[stage.load]]
pressure = "-2 kPa"
[[stage]]
machine = "bend"
solver = "explicit"
step_safety = 0.5
self_contact = true
medium_density = "1.2 kg/m3"
drag_coefficient = 0.47
directional_drag = "2 kPa s/m"
directional_drag_along = "normal"
gravity = [0, "-2 m/s2", -1]
[render]
size = [1, 16384]
fps = 24
film = false
tools = false
ground = false
gl = "osmesa"
up = "x"
field_of_view = "40 deg"
[render.camera]
azimuth = "90 deg"
elevation = "10 deg"
zoom = 2
orbit = "180 deg"
[output]
meshes_per_frame = true
)");
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    CHECK(reading.mistakes.empty());
    const SceneSpec& scene = *reading.scene;
    CHECK(scene.work_piece().material.young_modulus == 1e9);
    CHECK(scene.work_piece().material.poisson_ratio == 0.25);
    CHECK(scene.work_piece().material.density == Approx(1200));
    CHECK(scene.work_piece().material.yield_stress == 3e6);
    CHECK(scene.work_piece().material.hardening == 1e6);
    CHECK(scene.work_piece().material.strength == 4e6);
    CHECK(scene.work_piece().material.toughness == 2e3);
    CHECK(scene.work_piece().material.damping_ratio == 0.1);
    CHECK(scene.work_piece().material.friction == 0.4);
    CHECK(scene.work_piece().material.static_friction == 0.5);
    CHECK(scene.work_piece().material.restitution == 0.3);
    CHECK(scene.work_piece().material.stickiness == 2000);
    CHECK(scene.work_piece().mold.spacing.value() == Approx(0.005));
    CHECK_FALSE(scene.work_piece().mold.across.has_value());
    CHECK(scene.work_piece().mold.kind == MoldKind::block);
    CHECK(scene.work_piece().mold.cell_limit == 1000);
    CHECK(scene.skin.kind == SkinKind::boundary);
    const StageSpec& stage = scene.stage.at(0);
    CHECK(stage.name == "wring it");
    CHECK(stage.frames == 7);
    CHECK(stage.duration == 2);
    CHECK(stage.axis == WorldAxis::z);
    CHECK(stage.up == WorldAxis::minus_x);
    CHECK_FALSE(stage.remold);  // a block never is; the overrides below say true
    CHECK(stage.sim.solver == Solver::quasistatic);
    CHECK(stage.sim.tolerance == 1e-3);
    CHECK(stage.sim.iteration_limit == 900);
    CHECK(stage.sim.halving_limit == 2);
    CHECK(stage.sim.contact_stiffness == 3);
    CHECK(stage.sim.grip_stiffness == 30);
    CHECK(stage.sim.gravity == Vec3(0, -9.81, 0));
    CHECK(stage.parameter.at("angle") == Approx(-kPi));
    CHECK(stage.sim.self_contact);
    CHECK(stage.machine.gravity_strength == "0.5 + t*duration/4");
    REQUIRE(stage.machine.load.size() == 2);
    const LoadSpec& books = stage.machine.load[0];
    CHECK(books.name == "books");
    CHECK(books.force.value() == Expression3{"0", "-20 N", "0.1*length"});
    CHECK(books.on == Side::top);
    CHECK(books.box.value()[0] == Expression3{"-length/4", "-height", "-3 cm"});
    CHECK(books.box.value()[1] == Expression3{"length/4", "height", "3 cm"});
    CHECK(books.strength == "angle < 0 ? t : 0");
    const LoadSpec& suction = stage.machine.load[1];
    CHECK(suction.name == "load_2");
    CHECK_FALSE(suction.force);
    CHECK(suction.pressure == "-2 kPa");
    CHECK(suction.on == Side::all);
    CHECK_FALSE(suction.box);
    CHECK(suction.strength == "ramp(t, 0, 1)");
    CHECK(scene.stage.at(1).machine.load.empty());
    CHECK(scene.stage.at(1).name == "2-bend");
    CHECK(scene.stage.at(1).sim.solver == Solver::explicit_steps);
    CHECK(scene.stage.at(1).sim.step_safety == 0.5);
    CHECK(scene.stage.at(1).sim.self_contact);
    CHECK(scene.stage.at(1).sim.medium_density == 1.2);
    CHECK(scene.stage.at(1).sim.drag_coefficient == 0.47);
    CHECK(scene.stage.at(1).sim.directional_drag == 2000);
    CHECK(scene.stage.at(1).sim.directional_drag_along == DragAlong::normal);
    CHECK(scene.stage.at(1).sim.gravity == Vec3(0, -2, -1));
    CHECK(scene.render.width == 1);
    CHECK(scene.render.height == 16384);
    CHECK(scene.render.frame_rate == FrameRate{24, 1});
    CHECK_FALSE(scene.render.film);
    CHECK_FALSE(scene.render.tools);
    CHECK_FALSE(scene.render.ground);
    CHECK(scene.render.gl == GlProviderKind::osmesa);
    CHECK(scene.render.up == Up::x);
    CHECK(scene.render.field_of_view == Approx(40 * kPi / 180));
    REQUIRE(scene.render.camera.size() == 2);
    CHECK(scene.render.camera[0].azimuth == Approx(kPi / 2));
    CHECK(scene.render.camera[1].azimuth == Approx(3 * kPi / 2));
    CHECK(scene.render.camera[1].at == 1);
    CHECK(scene.render.camera[1].zoom == 2);
    CHECK(scene.output.meshes_per_frame);
}

TEST_CASE("camera keys are read in any order and come sorted") {
    const SceneFolder scratch;
    const SceneReading reading = read(scratch, kHead + R"(
[[stage]]
machine = "bend"
[render.camera]
keys = [
    {at = 1, eye = [0, "50 cm", 1], target = [0, 0, 0]},
    {at = 0, azimuth = "20 deg", target = ["10 cm", 0, 0]},
]
)");
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    const auto& camera = reading.scene->render.camera;
    REQUIRE(camera.size() == 2);
    CHECK(camera[0].azimuth == Approx(20 * kPi / 180));
    CHECK(camera[0].target.value() == Vec3(0.1, 0, 0));
    CHECK(!camera[0].eye);
    CHECK(camera[1].eye.value() == Vec3(0, 0.5, 1));
    CHECK(camera[1].target.value() == Vec3(0, 0, 0));
}

TEST_CASE("a single gravity points against a stage's up, and the pictures have that upward") {
    const SceneFolder scratch;
    const auto scene_with = [&](const std::string& stages) {
        const SceneReading reading = read(scratch, kHead + stages);
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return *reading.scene;
    };
    const std::string z = "[[stage]]\nmachine = \"floor\"\nup = \"z\"\ngravity = \"9.81 m/s2\"\n";
    const std::string bare = "[[stage]]\nmachine = \"bend\"\nup = \"z\"\n";
    const std::string y = "[[stage]]\nmachine = \"floor\"\ngravity = \"9.81 m/s2\"\n";
    const SceneSpec up = scene_with(z + bare);
    CHECK(up.stage[0].sim.gravity == Vec3(0, 0, -9.81));
    CHECK(up.render.up == Up::z);
    CHECK(scene_with(bare).render.up == Up::y);
    CHECK(scene_with(y).render.up == Up::y);
    CHECK(scene_with(y).stage[0].sim.gravity == Vec3(0, -9.81, 0));
    CHECK(scene_with(z + y).render.up == Up::y);
    const auto on = [&](const std::string& floor) {
        return scene_with("[[stage]]\nmachine = \"floor\"\nup = \"" + floor +
                          "\"\ngravity = \"9.81 m/s2\"\n");
    };
    CHECK(on("-y").render.up == Up::minus_y);
    CHECK(on("-x").render.up == Up::minus_x);
    CHECK(scene_with(z + "[render]\nup = \"x\"\n").render.up == Up::x);
}

TEST_CASE("what an earlier stage has strained may move without gravity, load or speed") {
    const SceneFolder scratch;
    const SceneReading reading = read(scratch, kHead + R"([mold]
across = 4
[[stage]]
machine = "twist"
angle = "5 deg"
[[stage]]
machine = "hold"
solver = "explicit"
duration = "1 s"
)");
    INFO(told(reading.mistakes, scratch.path()));
    CHECK(reading.mistakes.empty());
}

TEST_CASE("a byte order mark, carriage returns and comments change nothing") {
    const SceneFolder scratch;
    const std::string plain = kHead + "[[stage]]\nmachine = \"bend\" # with care\n";
    std::string odd = "\xEF\xBB\xBF";
    for (char c : plain) odd += c == '\n' ? std::string("\r\n") : std::string(1, c);
    const SceneReading reading = read(scratch, odd);
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    CHECK(reading.scene->stage.at(0).machine.name == "bend");
}

TEST_CASE("paths are relative to the file they stand in, from wherever the program runs") {
    const SceneFolder scratch;
    scratch.write("deep/er/scene.toml",
                  "[mesh]\nfile = \"../../bar.obj\"\n[material]\nname = "
                  "\"rubber\"\n[[inset]]\nname = \"lead\"\nfile = \"../core.obj\"\n"
                  "[[stage]]\nmachine = \"../mine/press.toml\"\n");
    scratch.write("deep/core.obj", "v 0 0 0\n");
    scratch.write("deep/mine/tool.obj", "v 0 0 0\n");
    scratch.write("deep/mine/press.toml",
                  "[[tool]]\nname = \"a\"\nshape = \"mesh\"\nfile = \"tool.obj\"\nlength = "
                  "\"height\"\nat = [0, 0, 0]\n");
    const auto before = std::filesystem::current_path();
    for (const char* from : {".", "deep", "deep/er"}) {
        std::filesystem::current_path(scratch.path() / from);
        const auto file =
            std::filesystem::relative(scratch.path() / "deep/er/scene.toml", scratch.path() / from);
        const SceneReading reading = read_scene(file, {}, shipped());
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        CHECK(reading.scene->work_piece().mesh.file == scratch.path() / "bar.obj");
        CHECK(reading.scene->stage[0].machine.tool[0].mesh ==
              scratch.path() / "deep/mine/tool.obj");
        CHECK(reading.scene->work_piece().inset[0].file == scratch.path() / "deep/core.obj");
        const auto& inputs = reading.scene->inputs;
        for (const char* file : {"deep/mine/tool.obj", "deep/core.obj"}) {
            CHECK(std::count(inputs.begin(), inputs.end(), scratch.path() / file) == 1);
        }
    }
    std::filesystem::current_path(before);
}

TEST_CASE("machines and materials beside the scene come before the shipped ones") {
    const SceneFolder scratch;
    scratch.write("materials.toml",
                  "[rubber]\nyoung_modulus = \"5 MPa\"\ndensity = 900\n[jelly]\nyoung_modulus = "
                  "1e3\ndensity = 1000\n");
    scratch.write("machines/bend.toml",
                  "[[grip]]\nname = \"all\"\nfrom = [-1, -1, -1]\nto = [1, 1, 1]\n");
    const SceneReading reading = read(scratch, kHead + "[[stage]]\nmachine = \"bend\"\n");
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    CHECK(reading.scene->work_piece().material.young_modulus == 5e6);
    CHECK(reading.scene->stage[0].machine.grip.size() == 1);
    const SceneReading other =
        read(scratch, kHead + "[[stage]]\nmachine = \"bend\"\n", {"material.name=copper"});
    REQUIRE(other.scene);
    CHECK(other.scene->work_piece().material.name == "copper");
}

TEST_CASE("a material that yields can be made elastic, and one that breaks whole") {
    const SceneFolder scratch;
    for (const char* infinite : {"inf", "+inf", "\"inf\"", "\"inf MPa\"", "\" +inf N/mm2 \""}) {
        const SceneReading reading =
            read(scratch, std::string("[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"pla\"\n") +
                              "yield_stress = " + infinite + "\nstrength = " + infinite +
                              "\n[[stage]]\nmachine = \"bend\"\n");
        INFO(infinite << "\n" << told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        CHECK(reading.mistakes.empty());
        CHECK(std::isinf(reading.scene->work_piece().material.yield_stress));
        CHECK_FALSE(reading.scene->work_piece().material.breaks());
    }
}

TEST_CASE("overrides count as if the file said so") {
    const SceneFolder scratch;
    const std::string text = kHead +
                             "[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\n[[stage]]\n"
                             "machine = \"twist\"\nname = \"last\"\n";
    const SceneReading reading =
        read(scratch, text,
             {"stage.1.angle=45 deg", "stage.last.angle=1.5", "stage.*.frames=3",
              "stage.twist.remold=true", "material.young_modulus=2 GPa", "render.size=[64, 48]",
              "render.camera.azimuth=30 deg", "mold.across=3", "mold.across=4",
              "output.meshes_per_frame=true", "material.name=\"copper\""});
    INFO(told(reading.mistakes, scratch.path()));
    REQUIRE(reading.scene);
    const SceneSpec& scene = *reading.scene;
    CHECK(scene.stage[0].parameter.at("angle") == Approx(kPi / 4));
    CHECK(scene.stage[1].parameter.at("angle") == Approx(1.5));
    CHECK(scene.stage[0].frames == 3);
    CHECK(scene.stage[1].frames == 3);
    CHECK(scene.stage[1].remold);
    CHECK(scene.work_piece().material.young_modulus == 2e9);
    CHECK(scene.work_piece().material.name == "copper");
    CHECK(scene.render.width == 64);
    CHECK(scene.render.camera[0].azimuth == Approx(kPi / 6));
    CHECK(scene.work_piece().mold.across.value() == 4);
    CHECK(scene.output.meshes_per_frame);
}

TEST_CASE("an override of across or spacing counts instead of the file's of the other") {
    const SceneFolder scratch;
    const auto mold = [&](const std::string& file, const std::vector<std::string>& overrides) {
        const std::string text =
            kHead + "[mold]\n" + file + "\n[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\n";
        const SceneReading reading = read(scratch, text, overrides);
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return reading.scene->work_piece().mold;
    };
    CHECK(mold("across = 5", {"mold.spacing=2 mm"}).spacing.value() == Approx(0.002));
    CHECK_FALSE(mold("across = 5", {"mold.spacing=2 mm"}).across.has_value());
    CHECK(mold("spacing = \"2 mm\"", {"mold.across=7"}).across.value() == 7);
    CHECK_FALSE(mold("spacing = \"2 mm\"", {"mold.across=7"}).spacing.has_value());
}

TEST_CASE("every shipped machine reads without a word") {
    const MachineCatalogue catalogue = machine_catalogue(shipped(), {});
    INFO(told(catalogue.mistakes, SWAGE_SOURCE_DIR));
    CHECK(catalogue.mistakes.empty());
    std::vector<std::string> names;
    for (const MachineSpec& machine : catalogue.machine) {
        INFO(machine.name);
        names.push_back(machine.name);
        CHECK_FALSE(machine.help.empty());
        for (const ParameterSpec& parameter : machine.parameter) {
            INFO(parameter.name);
            CHECK_FALSE(parameter.help.empty());
            CHECK_FALSE(parameter.low.empty());
            CHECK_FALSE(parameter.high.empty());
        }
    }
    for (const char* name : {"bend", "twist", "cut"}) {
        CHECK(std::count(names.begin(), names.end(), name) == 1);
    }
    CHECK(std::is_sorted(names.begin(), names.end()));
}

TEST_CASE("the shipped materials are many and within sense") {
    const MaterialCatalogue catalogue = material_catalogue(shipped(), {});
    INFO(told(catalogue.mistakes, SWAGE_SOURCE_DIR));
    CHECK(catalogue.mistakes.empty());
    CHECK(catalogue.material.size() >= 16);
    for (const Material& one : catalogue.material) {
        INFO(one.name);
        CHECK(one.young_modulus >= 1e5);
        CHECK(one.young_modulus <= 3e11);
        CHECK(one.density >= 10);
        CHECK(one.density <= 2e4);
        CHECK(one.poisson_ratio >= 0);
        CHECK(one.poisson_ratio < 0.5);
        CHECK((std::isinf(one.yield_stress) || one.yield_stress < 0.1 * one.young_modulus));
        CHECK((one.hardening == 0 || std::isfinite(one.yield_stress)));
        CHECK(one.hardening <= 0.05 * one.young_modulus);
        CHECK(one.breaks() == std::isfinite(one.toughness));
        if (one.breaks()) {
            CHECK(one.strength < 0.1 * one.young_modulus);
            CHECK(one.toughness >= 0.5);
            CHECK(one.toughness <= 1e5);
        }
        CHECK(one.friction > 0);
        CHECK(one.friction <= 1);
        CHECK(one.damping_ratio > 0);
        CHECK(one.damping_ratio <= 0.3);
    }
}

TEST_CASE("reading takes time in proportion to the stages and keys") {
    const SceneFolder scratch;
    const auto seconds = [&](int stages) {
        std::string text = kHead;
        for (int n = 0; n < stages; ++n) {
            text +=
                "[[stage]]\nmachine = \"bend\"\nangle = \"60 deg\"\nradius = \"3 cm\"\nframes = "
                "10\n";
        }
        const auto file = scratch.write("many.toml", text);
        const std::clock_t start = std::clock();
        const SceneReading reading = read_scene(file, {}, shipped());
        REQUIRE(reading.scene);
        CHECK(reading.scene->stage.size() == static_cast<std::size_t>(stages));
        return double(std::clock() - start) / CLOCKS_PER_SEC;
    };
    seconds(100);  // warm
    const double few = seconds(1000), many = seconds(10000);
    INFO(few << " s, " << many << " s");
    CHECK(many < 40 * few + 0.5);
    CHECK(many < 10);

    std::string keys = kHead + "[[stage]]\nmachine = \"bend\"\n[render.camera]\nkeys = [";
    for (int n = 0; n < 100000; ++n) keys += fmt::format("{{at = {}, zoom = 2}},", n / 1e5);
    const std::clock_t start = std::clock();
    const SceneReading reading = read(scratch, keys + "]\n");  // one line of 3e6 letters
    REQUIRE(reading.scene);
    CHECK(reading.scene->render.camera.size() == 100000);
    CHECK(double(std::clock() - start) / CLOCKS_PER_SEC < 10);
}
