// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_look.h"

#include "geometry/make_shape.h"
#include "geometry/mesh_write.h"
#include "pipeline/work_piece.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

SurfaceMaterial look_of(const Vec3& color, double roughness, double metallic, double clear = 0) {
    SurfaceMaterial look;
    look.color = color;
    look.roughness = roughness;
    look.metallic = metallic;
    look.clear = clear;
    return look;
}

const SurfaceMaterial kCopper = look_of({0.95, 0.64, 0.54}, 0.3, 1),
                      kIce = look_of({0.8, 0.9, 1}, 0.2, 0, 0.7);

InputMesh bar(bool has_look) {
    InputMesh input;
    input.mesh = make_shape("bar", {{"length", 0.4}, {"height", 0.1}, {"width", 0.1}}).mesh;
    if (!has_look) input.mesh.material.clear(), input.mesh.triangle_material.clear();
    return input;
}

BodySpec body_of(const SurfaceMaterial& look) {
    BodySpec body;
    body.look = look;
    body.mold.across = 3;
    return body;
}

}  // namespace

TEST_CASE("a mesh without a look has its material's, whatever draws it") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    const WorkPiece piece = make_work_piece(bar(false), body_of(kCopper), {kind});
    const SurfaceMaterial& look = piece.skin.material.front();
    CHECK(look.color == kCopper.color);
    CHECK(look.metallic == 1);
    CHECK(look.roughness == 0.3);
    // One of no look and no known material stays as it was.
    BodySpec plain;
    plain.mold.across = 3;
    CHECK(make_work_piece(bar(false), plain, {kind}).skin.material.front().color ==
          SurfaceMaterial().color);
}

TEST_CASE("that a look which the scene gives is hidden by the mesh's own is told as it is read") {
    const Scratch scratch;
    write_obj(scratch.path() / "bar.obj", bar(true).mesh);
    SceneSpec scene;
    BodySpec body = body_of(kIce);
    body.mesh.file = scratch.path() / "bar.obj";
    const auto told = [&](bool gives_look, bool wears_material) {
        body.gives_look = gives_look;
        body.wears_material = wears_material;
        scene.body = {body};
        return read_input_meshes(scene).at(0).finding;
    };
    REQUIRE(told(true, false).size() == 1);
    CHECK(told(true, false)[0].find("the mesh file says how it looks, so the look of the "
                                    "material is not seen: look = \"material\"") == 0);
    CHECK(told(false, false).empty());
    CHECK(told(true, true).empty());
}

TEST_CASE("a mesh keeps the look, the texture and the colours that it brings") {
    const WorkPiece piece = make_work_piece(bar(true), body_of(kIce), {});
    CHECK(piece.skin.material.front().name == "steel");
    CHECK(piece.skin.material.front().clear == 0);
    CHECK(piece.skin.material.front().metallic == 1);
    TriMesh colored = bar(false).mesh;
    colored.position_color.assign(colored.position.size(), Eigen::Vector3f(1, 0, 0));
    CHECK_FALSE(body_look(body_of(kIce), colored));
    TriMesh textured = bar(true).mesh;
    textured.material[0].texture = "/somewhere/skin.png";
    CHECK_FALSE(body_look(body_of(kIce), textured));
    // But where the scene asks for the material's.
    BodySpec asked = body_of(kIce);
    asked.wears_material = true;
    for (const TriMesh& mesh : {colored, textured}) {
        REQUIRE(body_look(asked, mesh));
        CHECK(body_look(asked, mesh)->clear == kIce.clear);
        CHECK(body_look(asked, mesh)->texture.empty());
    }
    const WorkPiece worn = make_work_piece(bar(true), asked, {});
    CHECK(worn.skin.material.size() == 1);
    CHECK(worn.skin.material.front().color == kIce.color);
}

TEST_CASE(
    "the scene's own colour wins, as rough and as clear as the material is where it is no "
    "metal") {
    const TriMesh mesh = bar(false).mesh;
    const Vec3 red(0.7, 0.1, 0.1);
    const auto painted = [&](std::optional<SurfaceMaterial> look, std::optional<bool> metal) {
        BodySpec body;
        body.look = look;
        body.color = red;
        body.metal = metal;
        const std::optional<SurfaceMaterial> all = body_look(body, mesh);
        REQUIRE(all);
        CHECK(all->color == red);
        return *all;
    };
    CHECK(painted(kIce, {}).roughness == kIce.roughness);
    CHECK(painted(kIce, {}).clear == kIce.clear);
    CHECK(painted(kIce, false).clear == 0);  // matt, as the scene says
    CHECK(painted(kIce, true).metallic == 1);
    CHECK(painted(kCopper, {}).metallic == 0);  // paint
    CHECK(painted(kCopper, {}).roughness == SurfaceMaterial().roughness);
    CHECK(painted(kCopper, true).metallic == 1);
    CHECK(painted({}, {}).roughness == SurfaceMaterial().roughness);
}
