// SPDX-License-Identifier: GPL-3.0-or-later
// Grips along different axes may hold the same points: an eighth of a body between its planes of
// symmetry.
#include <sstream>

#include "base/math.h"
#include "geometry/box.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/box_obj.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using namespace swage;

TEST_CASE("an eighth of a cube between three planes that meet stretches as Hooke has it") {
    const Scratch scratch;
    const fs::path folder = scratch.path();
    const auto plane = [](const char* name, const char* along, const char* from, const char* to,
                          const char* more) {
        return fmt::format(
            "[[grip]]\nname = \"{}\"\nalong = \"{}\"\ndrawn = false\nfrom = {}\nto = {}\n{}", name,
            along, from, to, more);
    };
    const char *low = "[-1, -1, -1]", *high = "[1, 1, 1]";
    put_text(folder / "octant.toml",
             plane("left", "x", low, "[\"-0.5*length\", 1, 1]", "") +
                 plane("bottom", "y", low, "[1, \"-0.5*height\", 1]", "") +
                 plane("back", "z", low, "[1, 1, \"-0.5*width\"]", "") +
                 plane("pull", "x", "[\"0.5*length\", -1, -1]", high,
                       "[grip.motion]\nmove = [\"0.001*length*t\", 0, 0]\n"));
    put_text(folder / "cube.obj", test::box_obj(Vec3::Constant(-0.05), Vec3::Constant(0.05)));
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"cube.obj\"\n[material]\n"
             "young_modulus = \"1 MPa\"\npoisson_ratio = 0.3\ndensity = 1000\n[mold]\nacross = 4\n"
             "[[stage]]\nmachine = \"octant.toml\"\nframes = 2\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--no-render", "--out", "out", "-q"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    Box box;
    std::istringstream mesh(bytes_of(folder / "out/meshes/1-octant.obj"));
    for (std::string line; std::getline(mesh, line);) {
        Vec3 p;
        if (!line.starts_with("v ")) continue;
        std::istringstream(line.substr(2)) >> p[0] >> p[1] >> p[2];
        box.grow(p);
    }
    const Vec3 strain = box.size() / 0.1 - Vec3::Ones();
    CHECK(strain.x() > 5e-4);
    CHECK(strain.y() == Approx(-0.3 * strain.x()).epsilon(0.01));
    CHECK(strain.z() == Approx(-0.3 * strain.x()).epsilon(0.01));
    const double force = last_row(folder / "out/curves/1-octant.csv").at("pull force x [N]");
    CHECK(std::abs(force) == Approx(1e6 * 0.01 * strain.x()).epsilon(0.01));
}
