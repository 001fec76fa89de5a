// SPDX-License-Identifier: GPL-3.0-or-later
// Blades that meet what has moved since another came, or moves as they come.
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/box_obj.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// From the least on [m3].
std::vector<double> part_volumes(const fs::path& file) {
    const swage::TriMesh mesh = swage::read_mesh(file);
    const swage::Components parts = swage::surface_components(mesh);
    std::vector<double> volume(std::size_t(parts.count), 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto [a, b, c] = mesh.triangle[t];
        volume[std::size_t(parts.triangle_component[t])] +=
            mesh.position[a].cross(mesh.position[b]).dot(mesh.position[c]) / 6;
    }
    std::ranges::sort(volume);
    return volume;
}

void check_volumes(const fs::path& file, std::vector<double> expected) {
    std::ranges::sort(expected);
    const std::vector<double> volume = part_volumes(file);
    REQUIRE(volume.size() == expected.size());
    for (std::size_t n = 0; n < volume.size(); ++n) {
        CHECK(volume[n] == Approx(expected[n]).epsilon(1e-3));
    }
}

}  // namespace

TEST_CASE("a blade cuts a body as it lies when that blade comes, not as it lay for one before it") {
    // One parts it as it falls by 3 cm, the other 3.1 cm above the floor.
    const Scratch scratch;
    const fs::path folder = scratch.path();
    fs::create_directory(folder / "machines");
    put_text(folder / "machines/two.toml",
             "help = \"two blades over a floor\"\nmoves = true\nupright = true\n"
             "[[tool]]\nname = \"floor\"\nshape = \"box\"\nsize = [2, 2, 0.1]\naxis = [0, 1, 0]\n"
             "at = [0, 0, 0]\ntouch = [0, 1, 0]\ngap = 0.03\nfinish = \"endless\"\n"
             "[[blade]]\nname = \"early\"\n"
             "edge = [[-0.07, 0.033, -0.24], [-0.07, 0.033, 0.24]]\n"
             "[blade.motion]\nmove = [\"0.14*line(t, 0, 0.08)\", 0, 0]\n"
             "[[blade]]\nname = \"late\"\n"
             "edge = [[-0.07, -0.059, -0.24], [-0.07, -0.059, 0.24]]\n"
             "[blade.motion]\nmove = [\"0.14*line(t, 0.6, 0.9)\", 0, 0]\n");
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
             "/assets/meshes/cube.obj\"\nlength = \"12 cm\"\n[material]\n"
             "young_modulus = \"2 MPa\"\ndensity = 1000\nrestitution = 0\ndamping_ratio = 0.3\n"
             "[mold]\nacross = 4\n[[stage]]\nmachine = \"two\"\ngravity = \"9.81 m/s2\"\n"
             "self_contact = true\nduration = \"0.5 s\"\nframes = 100\n");
    const Outcome outcome = run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(!says(outcome.err, "turns back"));  // the other, which stands meanwhile
    const std::vector<double> volume = part_volumes(folder / "out/meshes/1-two.obj");
    REQUIRE(volume.size() == 3);
    // 2.7 cm above its middle, and what is 3.1 cm high.
    CHECK(volume[0] == Approx(0.12 * 0.12 * 0.027).epsilon(0.05));
    CHECK(volume[1] == Approx(0.12 * 0.12 * 0.031).epsilon(0.05));
}

TEST_CASE(
    "blades that cross the way of a slower one part what falls past them where it lies then") {
    // The slow one comes from below through x = 3 mm all the while; each of the others goes along x
    // within 10 ms.
    const Scratch scratch;
    const fs::path folder = scratch.path();
    fs::create_directory(folder / "machines");
    const auto across = [](const char* name, double time) {
        return fmt::format(
            "[[blade]]\nname = \"{}\"\nedge = [[-0.07, 0, -1], [-0.07, 0, 1]]\n"
            "[blade.motion]\nmove = [\"0.14*line(t, {}/0.12, {}/0.12)\", 0, 0]\n",
            name, time, time + 0.01);
    };
    put_text(folder / "machines/cross.toml",
             "help = \"blades\"\nmoves = true\n[[blade]]\nname = \"slow\"\n"
             "edge = [[0.003, -0.075, -1], [0.003, -0.075, 1]]\n"
             "[blade.motion]\nmove = [0, \"0.08*t\", 0]\n" +
                 across("first", 0.06) + across("second", 0.09));
    put_text(folder / "box.obj",
             swage::test::box_obj(swage::Vec3(-1, -1, -1), swage::Vec3(1, 1, 1)));
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"box.obj\"\nlength = \"12 cm\"\n[material]\n"
             "young_modulus = \"5 MPa\"\ndensity = 1000\ndamping_ratio = 0.3\n"
             "[mold]\nacross = 6\n[[stage]]\nmachine = \"cross\"\ngravity = \"9.81 m/s2\"\n"
             "self_contact = true\nduration = \"0.12 s\"\nframes = 240\n");
    const Outcome outcome = run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    // As far below each of them as it has fallen when its leg begins, of half a millisecond.
    const double first = 0.5 * 9.81 * 0.0605 * 0.0605, second = 0.5 * 9.81 * 0.0905 * 0.0905;
    std::vector<double> expected;
    for (const double width : {0.057, 0.063}) {
        for (const double height : {0.06 + first, second - first, 0.06 - second}) {
            expected.push_back(0.12 * width * height);
        }
    }
    check_volumes(folder / "out/meshes/1-cross.obj", expected);
}

TEST_CASE("a blade cuts what grips have carried on since another came where it is by then") {
    const bool moves = GENERATE(false, true);
    const Scratch scratch;
    const fs::path folder = scratch.path();
    fs::create_directory(folder / "machines");
    std::string machine = "help = \"two blades\"\n";
    for (const auto& [name, from, to] :
         {std::tuple("left", -1.0, -0.045), std::tuple("mid", -0.008, 0.008),
          std::tuple("right", 0.045, 1.0)}) {
        machine += fmt::format(
            "[[grip]]\nname = \"{}\"\nfrom = [{}, -1, -1]\nto = [{}, 1, 1]\n"
            "[grip.motion]\nmove = [0, \"0.02*line(t, 0.45, 0.55)\", 0]\n",
            name, from, to);
    }
    put_text(folder / "machines/carry.toml",
             machine +
                 "[[blade]]\nname = \"early\"\nedge = [[0.025, 0.1, -1], [0.025, 0.1, 1]]\n"
                 "[blade.motion]\nmove = [0, \"-0.2*line(t, 0, 0.3)\", 0]\n"
                 "[[blade]]\nname = \"late\"\n"
                 "edge = [[-0.07, -0.017, -1], [-0.07, -0.017, 1]]\n"
                 "[blade.motion]\nmove = [\"0.14*line(t, 0.6, 0.9)\", 0, 0]\n");
    put_text(folder / "box.obj",
             swage::test::box_obj(swage::Vec3(-1, -1, -1), swage::Vec3(1, 1, 1)));
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"box.obj\"\nlength = \"12 cm\"\n[material]\n"
             "young_modulus = \"1 MPa\"\ndensity = 1000\ndamping_ratio = 0.3\n"
             "[mold]\nacross = 8\n[[stage]]\nmachine = \"carry\"\nself_contact = true\n" +
                 std::string(moves ? "solver = \"explicit\"\nduration = \"0.1 s\"\nframes = 80\n"
                                   : "frames = 40\n"));
    const Outcome outcome = run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(!says(outcome.err, "moved out of it"));
    // The late one at 1.7 cm below where the middle was first, 3.7 cm below where it is.
    std::vector<double> expected;
    for (const double length : {0.035, 0.085}) {
        for (const double height : {0.023, 0.097}) expected.push_back(0.12 * length * height);
    }
    check_volumes(folder / "out/meshes/1-carry.obj", expected);
}

TEST_CASE("what gravity speeds up past a slow edge is cut as it passes") {
    const std::string gap = GENERATE("0.0001", "0.001", "0.03");
    CAPTURE(gap);
    const Scratch scratch;
    fs::create_directory(scratch.path() / "machines");
    put_text(scratch.path() / "machines/rise.toml",
             "help = \"a blade from below\"\nmoves = true\n[[blade]]\nname = \"blade\"\n"
             "edge = [[0.001, \"-height/2 - " +
                 gap + "\", -1], [0.001, \"-height/2 - " + gap +
                 "\", 1]]\n[blade.motion]\nmove = [0, \"0.05*duration*t\", 0]\n");
    put_text(scratch.path() / "scene.toml",
             "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
             "/assets/meshes/cube.obj\"\nlength = \"12 cm\"\n[material]\nname = \"rubber\"\n"
             "[mold]\nacross = 4\n[[stage]]\nmachine = \"rise\"\ngravity = \"9.81 m/s2\"\n"
             "duration = \"0.3 s\"\nframes = 60\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, scratch.path());
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(parse_json(bytes_of(scratch.path() / "out/run.json")).at("stages").at(0).at("pieces") ==
          2);
    CHECK(!says(outcome.err, "separated nothing"));
}

TEST_CASE("what lies on a floor as a stage begins does not fall past a blade from below") {
    // In a frame of many legs, as a tool far away goes round.
    const Scratch scratch;
    const fs::path folder = scratch.path();
    fs::create_directory(folder / "machines");
    put_text(folder / "machines/lie.toml",
             "help = \"a blade that goes in\"\nmoves = true\nupright = true\n"
             "[[tool]]\nname = \"floor\"\nshape = \"box\"\nsize = [2, 2, 0.1]\naxis = [0, 1, 0]\n"
             "at = [0, 0, 0]\ntouch = [0, 1, 0]\ngap = 0\nfinish = \"endless\"\n"
             "[[tool]]\nname = \"far\"\nshape = \"box\"\nsize = [0.1, 0.1, 0.1]\nat = [3, 0, 0]\n"
             "[tool.motion]\nmove = [\"0.5*sin(9*t)\", 0, \"0.5*cos(9*t)\"]\n"
             "[[blade]]\nname = \"blade\"\n"
             "edge = [[0.003, \"-height/2 - 0.001\", -1], [0.003, \"-height/2 - 0.001\", 1]]\n"
             "[blade.motion]\nmove = [0, \"0.05*line(t, 0.1, 1)\", 0]\n");
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
             "/assets/meshes/cube.obj\"\nlength = \"12 cm\"\n[material]\n"
             "young_modulus = \"1 MPa\"\ndensity = 1000\nrestitution = 0\n"
             "[mold]\nacross = 6\n[[stage]]\nmachine = \"lie\"\ngravity = \"9.81 m/s2\"\n"
             "duration = \"0.2 s\"\nframes = 2\n");
    const Outcome outcome = run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(part_volumes(folder / "out/meshes/1-lie.obj").size() == 1);
    CHECK(!says(outcome.err, "moved out of it"));
}

TEST_CASE("what a blade's second stroke finds is not cut, and told") {
    // It goes down and up, and perhaps once more; while it is below grips carry the body on by 3
    // cm, or it flies on.
    const bool flies = GENERATE(false, true);
    const bool moves = GENERATE(true, false);
    const bool again = GENERATE(true, false);
    CAPTURE(flies, moves, again);
    const Scratch scratch;
    const fs::path folder = scratch.path();
    fs::create_directory(folder / "machines");
    std::string machine = "help = \"a chopper\"\n";
    if (flies) {
        machine += "moves = true\n";
    } else {
        for (const char* place : {"name = \"left\"\nfrom = [-1, -1, -1]\nto = [-0.04, 1, 1]\n",
                                  "name = \"right\"\nfrom = [0.04, -1, -1]\nto = [1, 1, 1]\n"}) {
            machine += fmt::format(
                "[[grip]]\n{}[grip.motion]\nmove = [\"{}*line(t, 0.21, 0.29)\", 0, 0]\n", place,
                moves ? 0.03 : 0.0);
        }
    }
    put_text(folder / "machines/chop.toml",
             machine +
                 "[[blade]]\nname = \"chop\"\nedge = [[0.01, 0.1, -1], [0.01, 0.1, 1]]\n"
                 "[blade.motion]\nmove = [0, \"-0.25*(line(t, 0, 0.2) - line(t, 0.3, 0.5)" +
                 (again ? " + line(t, 0.5, 0.7) - line(t, 0.7, 0.9)" : "") + ")\", 0]\n");
    put_text(folder / "box.obj",
             swage::test::box_obj(swage::Vec3(-1, -1, -1), swage::Vec3(1, 1, 1)));
    put_text(folder / "scene.toml",
             fmt::format("[mesh]\nfile = \"box.obj\"\nlength = \"12 cm\"\n{}"
                         "[material]\nyoung_modulus = \"20 MPa\"\ndensity = 1000\n"
                         "[mold]\nacross = 6\n[[stage]]\nmachine = \"chop\"\nframes = 40\n{}",
                         flies && moves ? "velocity = [\"0.4 m/s\", 0, 0]\n" : "",
                         flies ? "gravity = 0\nduration = \"0.1 s\"\n" : ""));
    const Outcome outcome = run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(parse_json(bytes_of(folder / "out/run.json")).at("stages").at(0).at("pieces") == 2);
    CHECK(says(outcome.err, "give each of its strokes a stage of its own") == (moves && again));
}
