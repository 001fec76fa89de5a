// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/memory_cost.h"

#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "pipeline/cost.h"
#include "render/picture_bytes.h"
#include "render/png.h"
#include "render/targets.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

// A body of 3 cells across and one stage.
struct DrawnScene {
    InputMesh input;
    SceneSpec scene;

    DrawnScene(const std::string& shape, const std::map<std::string, double>& size) {
        input.mesh = make_shape(shape, size).mesh;
        scene.body.resize(1);
        scene.body[0].mold.across = 3;
        scene.stage.resize(1);
    }
    RunCost cost(bool draw = true) const {
        RunOptions options;
        options.draw = draw;
        return estimate_cost(scene, {input}, options);
    }
};

}  // namespace

TEST_CASE("what pictures take of memory is told by their pixels, passes and textures") {
    DrawnScene bar("bar", {});
    const test::Scratch scratch;
    const auto memory = [&](int width, int height) {
        bar.scene.render.width = width;
        bar.scene.render.height = height;
        return bar.cost();
    };
    const RunCost small = memory(64, 64), large = memory(3840, 2160), larger = memory(7680, 2160);
    const double pixels = 3840 * 2160;
    CHECK(larger.memory_bytes - large.memory_bytes ==
          Approx(picture_bytes(bar.scene.render, true) / 2));
    // 680 MiB were measured at 3840 x 2160, and 2,332 with all passes.
    CHECK(large.memory_bytes == Approx(696e6).epsilon(0.1));
    bar.scene.render.passes = {PicturePass::beauty, PicturePass::motion, PicturePass::depth,
                               PicturePass::piece,  PicturePass::normal, PicturePass::matte};
    CHECK(memory(3840, 2160).memory_bytes == Approx(2446e6).epsilon(0.1));
    CHECK(memory(1920, 1080).memory_bytes == Approx(742e6).epsilon(0.1));
    bar.scene.render.passes.clear();
    // Without pictures none of it.
    CHECK(small.undrawn_memory_bytes == large.undrawn_memory_bytes);
    CHECK(small.undrawn_memory_bytes == bar.cost(false).memory_bytes);
    CHECK(large.memory_bytes > small.memory_bytes + 60 * (pixels - 64 * 64));
    // Of a mesh that is too fine for samples less.
    DrawnScene ball("sphere", {{"division", 95}});
    REQUIRE(ball.input.mesh.triangle.size() > kMostMultisampledTriangles);
    ball.scene.render.width = 3840;
    ball.scene.render.height = 2160;
    CHECK(ball.cost().memory_bytes < 0.9 * large.memory_bytes);
    // A texture, as it is drawn with or as it is read.
    const int side = 2000;
    write_png(scratch.path() / "fine.png",
              {side, side, std::vector<std::uint8_t>(3 * side * side)});
    bar.input.mesh.material.resize(1);
    bar.input.mesh.material[0].texture = scratch.path() / "fine.png";
    CHECK(memory(3840, 2160).memory_bytes - large.memory_bytes ==
          Approx(texture_bytes(side, side).kept));
    CHECK(memory(64, 64).memory_bytes - small.memory_bytes >
          0.9 * (texture_bytes(side, side).kept + texture_bytes(side, side).reading));
    bar.input.mesh.material[0].texture = scratch.path() / "missing.png";
    CHECK(memory(3840, 2160).memory_bytes == large.memory_bytes);
}

TEST_CASE("what is cut is told with the places where its surface may meet itself") {
    constexpr int kAcross = 10;
    DrawnScene cube("bar", {});
    cube.input.mesh = box_mesh({Vec3::Zero(), Vec3::Ones()});
    cube.scene.body[0].mold.across = kAcross;
    const auto memory = [&](std::size_t blades, double side = 1) {
        cube.scene.stage[0].machine.blade.resize(blades);
        cube.input.mesh = box_mesh({Vec3::Zero(), Vec3::Constant(side)});
        return cube.cost(false).memory_bytes;
    };
    // Each blade lays open two planes of cells' faces, each with four points; each of these is a
    // place of contact and what is found of it: 81 MB were measured of 46,000.
    const double faces = kAcross * kAcross, place = 81e6 / 46e3;
    CHECK(memory(2) - memory(1) == Approx(4 * 2 * faces * place).epsilon(0.05));
    CHECK(memory(9) - memory(1) == Approx(8 * (memory(2) - memory(1))));
    CHECK(memory(1) - memory(0) > 4 * (6 + 2) * faces * 0.9 * place);
    CHECK(memory(2, 0.01) - memory(1, 0.01) == Approx(memory(2) - memory(1)));
    // Of a bar across its length, of blades of several names in any direction.
    DrawnScene bar("bar", {});
    const auto faces_of = [&](const std::vector<std::string>& names) {
        bar.scene.stage[0].machine.blade.clear();
        for (const std::string& name : names) {
            bar.scene.stage[0].machine.blade.emplace_back().name = name;
        }
        return cut_faces(bar.scene, box_mesh(Vec3::Zero(), Vec3(8, 1, 1)), 0.5);
    };
    CHECK(faces_of({}) == 0);
    CHECK(faces_of({"blade"}) == Approx(2 * 4));
    CHECK(faces_of({"across", "along"}) == Approx(2 * 2 * 4 * 4));
}
