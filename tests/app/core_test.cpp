// SPDX-License-Identifier: GPL-3.0-or-later
// Plugs that are cut out all around.
#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/box_obj.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("a plug takes all of its skin along, however close its edge runs by particles") {
    // Round an axis the path is bent between the points of the edge: here a column of particles
    // lies between that and the chord that parts the matter.
    const Scratch scratch;
    const std::filesystem::path folder = scratch.path();
    put_text(folder / "slab.obj", test::box_obj(Vec3(-0.1, -0.015, -0.1), Vec3(0.1, 0.015, 0.1)));
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"slab.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 4\n"
             "[[stage]]\nmachine = \"core\"\npetals = 10\ndepth = 0.4\nradius = \"5 cm\"\n"
             "lift = \"4 cm\"\nframes = 4\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--no-render", "--out", "out", "-q"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    std::istringstream mesh(bytes_of(folder / "out/meshes/1-core.obj"));
    std::vector<double> height;
    int hole = 0, plug = 0, between = 0;
    for (std::string line, corner; std::getline(mesh, line);) {
        std::istringstream words(line.substr(std::min<std::size_t>(2, line.size())));
        if (line.starts_with("v ")) {
            double x = 0;
            words >> x >> height.emplace_back();
        }
        if (!line.starts_with("f ")) continue;
        bool is_low = false, is_high = false;
        while (words >> corner) {
            (height.at(std::stoul(corner) - 1) < 0.02 ? is_low : is_high) = true;
        }
        ++(is_low && is_high ? between : is_low ? hole : plug);
    }
    CHECK(hole > 1000);
    CHECK(plug > 1000);
    CHECK(between == 0);
}
