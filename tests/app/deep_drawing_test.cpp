// SPDX-License-Identifier: GPL-3.0-or-later
// A sheet that a punch draws through a die.
#include <algorithm>
#include <cmath>

#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using swage::Vec3;

namespace {

constexpr double kRadius = 0.018, kThick = 0.004;  // of a round blank with its axis along x [m]

double radius_of(const Vec3& p) { return std::hypot(p.y(), p.z()); }

}  // namespace

TEST_CASE("a round blank is drawn into a round cup, which keeps its volume and thins little") {
    const Scratch scratch;
    const fs::path folder = scratch.path(), blank = folder / "blank.obj";
    REQUIRE(run_swage({"make", "rod", "--length", "4 mm", "--diameter", "36 mm", "--division", "1",
                       "--out", blank.string()})
                .code == 0);
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"blank.obj\"\n[material]\nname = \"soft_aluminium\"\n"
             "[mold]\nacross = 2\n[[stage]]\nmachine = \"draw\"\nup = \"x\"\ndepth = \"10 mm\"\n"
             "radius = \"11 mm\"\ncorner = \"4 mm\"\nentry = \"3 mm\"\nframes = 20\nrelease = 0\n");
    const Outcome ran = run_swage({"run", (folder / "scene.toml").string(), "--out",
                                   (folder / "run").string(), "--no-render", "-q"});
    CHECK(ran.code == 0);
    CHECK(ran.err.empty());

    const swage::TriMesh before = swage::read_mesh(blank);
    const swage::TriMesh after = swage::read_mesh(folder / "run/meshes/1-draw.obj");
    CHECK(swage::check_mesh(after).volume ==
          Approx(swage::check_mesh(before).volume).epsilon(1e-3));
    double middle[2] = {};  // of the lower and the upper face
    for (const double side : {-1.0, 1.0}) {
        double least = 1, most = 0;
        for (std::size_t v = 0; v < before.position.size(); ++v) {
            const Vec3& was = before.position[v];
            if (was.x() * side < 0) continue;
            const Vec3& is = after.position[v];
            if (radius_of(was) < 1e-6) middle[side > 0] = is.x();
            if (radius_of(was) < 0.999 * kRadius) continue;
            least = std::min(least, radius_of(is)), most = std::max(most, radius_of(is));
        }
        // The rim has come in, on a cubic lattice as far to all sides.
        CHECK(most < 0.94 * kRadius);
        CHECK(most - least < 0.01 * kRadius);
    }
    // Under the punch the sheet is at least as low as that goes, and about as thick as it was.
    CHECK(middle[1] < 0.5 * kThick - 0.01 + 0.02 * kThick);
    CHECK(middle[1] - middle[0] == Approx(kThick).epsilon(0.07));
}
