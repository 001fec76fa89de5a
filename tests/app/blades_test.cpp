// SPDX-License-Identifier: GPL-3.0-or-later
// Blades that meet what has moved since another came, or moves as they come.
#include <algorithm>

#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("a blade cuts a body as it lies when that blade comes, not as it lay "
          "for one before it") {
  // One parts it as it falls by 3 cm, the other 3.1 cm above the floor.
  const Scratch scratch;
  const fs::path folder = scratch.path();
  fs::create_directory(folder / "machines");
  put_text(
      folder / "machines/two.toml",
      "help = \"two blades over a floor\"\nmoves = true\nupright = true\n"
      "[[tool]]\nname = \"floor\"\nshape = \"box\"\nsize = [2, 2, 0.1]\naxis = "
      "[0, 1, 0]\n"
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
           "young_modulus = \"50 MPa\"\ndensity = 1000\nrestitution = "
           "0\ndamping_ratio = 0.3\n"
           "[mold]\nacross = 6\n[[stage]]\nmachine = \"two\"\ngravity = \"9.81 "
           "m/s2\"\n"
           "self_contact = true\nduration = \"0.5 s\"\nframes = 100\n");
  const Outcome outcome =
      run_swage({"run", "scene.toml", "--no-render", "--out", "out"}, folder);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(!says(outcome.err,
              "bends or turns")); // the other, which stands meanwhile
  const swage::TriMesh mesh = swage::read_mesh(folder / "out/meshes/1-two.obj");
  const swage::Components parts = swage::surface_components(mesh);
  REQUIRE(parts.count == 3);
  std::vector<double> volume(3, 0.0);
  for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
    const auto [a, b, c] = mesh.triangle[t];
    volume[std::size_t(parts.triangle_component[t])] +=
        mesh.position[a].cross(mesh.position[b]).dot(mesh.position[c]) / 6;
  }
  std::ranges::sort(volume);
  // 2.7 cm above its middle, and what is 3.1 cm high.
  CHECK(volume[0] == Approx(0.12 * 0.12 * 0.027).epsilon(0.05));
  CHECK(volume[1] == Approx(0.12 * 0.12 * 0.031).epsilon(0.05));
}

TEST_CASE("what gravity speeds up past a slow edge is cut as it passes") {
  const std::string gap = GENERATE("0.0001", "0.001", "0.03");
  CAPTURE(gap);
  const Scratch scratch;
  fs::create_directory(scratch.path() / "machines");
  put_text(scratch.path() / "machines/rise.toml",
           "help = \"a blade from below\"\nmoves = true\n[[blade]]\nname = "
           "\"blade\"\n"
           "edge = [[0.001, \"-height/2 - " +
               gap + "\", -1], [0.001, \"-height/2 - " + gap +
               "\", 1]]\n[blade.motion]\nmove = [0, \"0.05*duration*t\", 0]\n");
  put_text(scratch.path() / "scene.toml",
           "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
           "/assets/meshes/cube.obj\"\nlength = \"12 cm\"\n[material]\nname = "
           "\"rubber\"\n"
           "[mold]\nacross = 6\n[[stage]]\nmachine = \"rise\"\ngravity = "
           "\"9.81 m/s2\"\n"
           "duration = \"0.3 s\"\nframes = 60\n");
  const Outcome outcome = run_swage(
      {"run", "scene.toml", "--no-render", "--out", "out"}, scratch.path());
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(parse_json(bytes_of(scratch.path() / "out/run.json"))
            .at("stages")
            .at(0)
            .at("pieces") == 2);
  CHECK(!says(outcome.err, "separated nothing"));
}
