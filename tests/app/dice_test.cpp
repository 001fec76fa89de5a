// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_mesh.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("the dicer leaves blocks of one size in their places, which then fall apart") {
    const Scratch scratch;
    const std::filesystem::path folder = scratch.path();
    write_obj(folder / "loaf.obj", box_mesh(Vec3(-0.3, -0.11, -0.1), Vec3(0.3, 0.11, 0.1)));
    put_text(folder / "scene.toml",
             "[mesh]\nfile = \"loaf.obj\"\n[material]\nname = \"rubber\"\n[mold]\nacross = 5\n"
             "[[stage]]\nmachine = \"dice\"\naxis = \"x\"\nup = \"y\"\nslices = 5\nstrips = 2\n"
             "layers = 2\nframes = 10\n"
             "[[stage]]\nmachine = \"floor\"\ndrop = \"1 cm\"\ngravity = 9.81\n"
             "duration = \"60 ms\"\nframes = 2\n");
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--no-render", "--out", "out", "-q"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.err.empty());
    for (const char* stage : {"out/meshes/1-dice.obj", "out/meshes/2-floor.obj"}) {
        const TriMesh mesh = read_mesh(folder / stage);
        REQUIRE(mesh.part_name.size() == 20);
        std::vector<double> volume(20, 0.0);
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
            const auto& [a, b, c] = mesh.triangle[t];
            volume[std::size_t(mesh.triangle_part[t])] +=
                mesh.position[std::size_t(a)].dot(
                    mesh.position[std::size_t(b)].cross(mesh.position[std::size_t(c)])) /
                6;
        }
        const bool is_still = std::string(stage).find("dice") != std::string::npos;
        for (const double one : volume) {
            CHECK(one == Approx(0.6 * 0.22 * 0.2 / 20).epsilon(is_still ? 1e-3 : 0.03));
        }
    }
}
