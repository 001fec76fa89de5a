// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_look.h"

#include <fstream>

#include "geometry/make_shape.h"
#include "geometry/mesh_write.h"
#include "pipeline/work_piece.h"
#include "render/png.h"
#include "scene/mistake.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"
#include "tests/shared/says.h"
#include "tests/shared/scratch.h"

using namespace swage;
using namespace swage::test;

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

TEST_CASE(
    "the scene's texture is all that is drawn on a mesh, and of the file's look nothing is told") {
    const Scratch scratch;
    TriMesh mesh = bar(true).mesh;
    mesh.position_color.assign(mesh.position.size(), Eigen::Vector3f(1, 0, 0));
    write_obj(scratch.path() / "bar.obj", mesh);
    std::ofstream(scratch.path() / "bar.mtl", std::ios::app) << "map_Kd gone.png\n";
    write_png(scratch.path() / "cow.png", {1, 1, {1, 2, 3}});
    SceneSpec scene;
    scene.body = {body_of(kIce), body_of(kIce)};
    for (BodySpec& body : scene.body) {
        body.mesh.file = scratch.path() / "bar.obj";
        body.gives_look = true;
    }
    scene.body[1].name = "other";
    scene.body[0].mesh.texture = scratch.path() / "cow.png";
    const std::vector<InputMesh> input = read_input_meshes(scene);
    CHECK(input[0].finding.empty());
    CHECK(input[1].finding.size() == 2);  // the image is missing; the material's look is hidden
    for (const SkinKind kind : {SkinKind::mount, SkinKind::boundary}) {
        const WorkPiece piece = make_work_piece(input[0], scene.body[0], {kind});
        REQUIRE(piece.skin.material.size() == 1);
        const SurfaceMaterial& look = piece.skin.material[0];
        CHECK(look.texture == scratch.path() / "cow.png");
        CHECK(look.color == Vec3::Ones());
        CHECK(look.clear == kIce.clear);
        CHECK(piece.skin.position_color.empty());
        CHECK_FALSE(piece.skin.triangle_uv.empty());
    }
}

TEST_CASE(
    "a texture that is no picture, or has no place on the mesh, is refused where it is named") {
    const Scratch scratch;
    write_png(scratch.path() / "cow.png", {1, 1, {1, 2, 3}});
    scratch.write("torn.png", "\x89PNG\r\n\x1a\n");
    TriMesh plain = bar(false).mesh;
    write_obj(scratch.path() / "bar.obj", plain);
    plain.uv.clear(), plain.triangle_uv.clear();
    write_obj(scratch.path() / "plain.obj", plain);
    const auto why = [&](const char* file, const char* texture, SkinKind skin, MoldKind mold) {
        SceneSpec scene;
        BodySpec body = body_of(kIce);
        body.mesh.file = scratch.path() / file;
        body.mesh.texture = scratch.path() / texture;
        body.mold.kind = mold;
        scene.body = {body};
        scene.skin.kind = skin;
        try {
            read_input_meshes(scene);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(why("bar.obj", "cow.png", SkinKind::boundary, MoldKind::shape).empty());
    CHECK(why("bar.obj", "cow.png", SkinKind::mount, MoldKind::block).empty());
    CHECK(says(why("bar.obj", "torn.png", SkinKind::mount, MoldKind::shape), "torn.png: "));
    CHECK(says(why("plain.obj", "cow.png", SkinKind::mount, MoldKind::shape),
               "the mesh plain.obj has no texture coordinates"));
    CHECK(says(why("bar.obj", "cow.png", SkinKind::boundary, MoldKind::block),
               "the boundary of a block has no texture coordinates"));
}
