// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "skin/new_look.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"

namespace fs = std::filesystem;

TEST_CASE("a cut through what has flowed unevenly has flat faces") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "gear.toml", out = scratch.path() / "out";
    put_text(scene, "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
                    "/assets/meshes/gear.obj\"\n[material]\nname = \"abs\"\n[mold]\nacross = 3\n"
                    "[[stage]]\nmachine = \"press\"\naxis = \"x\"\ndepth = 0.3\nframes = 1\n"
                    "[[stage]]\nmachine = \"cut\"\naxis = \"z\"\ntilt = \"45 deg\"\nframes = 3\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--no-render", "--out", out.string()});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const swage::TriMesh mesh = swage::read_mesh(out / "meshes/2-cut.obj");
    const swage::Components parts = swage::surface_components(mesh);
    REQUIRE(parts.count == 2);
    std::vector<swage::Vec3> sum(2, swage::Vec3::Zero());
    std::vector<double> area(2, 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        if (mesh.material[mesh.triangle_material[t]].name != swage::kCutMaterial) continue;
        const auto [a, b, c] = mesh.triangle[t];
        const swage::Vec3 own =
            (mesh.position[b] - mesh.position[a]).cross(mesh.position[c] - mesh.position[a]);
        sum[parts.triangle_component[t]] += own;
        area[parts.triangle_component[t]] += own.norm();
    }
    for (int part : {0, 1}) CHECK(sum[part].norm() > 0.999 * area[part]);
}
