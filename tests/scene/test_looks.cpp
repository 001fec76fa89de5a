// SPDX-License-Identifier: GPL-3.0-or-later
// How a scene asks to be seen.
#include "scene/catalogue.h"
#include "tests/scene/bad_scene.h"
#include "tests/shared/says.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("a scene says where light comes from, what is behind and which edges are sharp") {
    const auto read = [](const std::string& rest) {
        const SceneFolder scratch;
        const Parts parts = with(&Parts::rest, rest);
        SceneReading reading = read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        REQUIRE(reading.scene);
        return std::move(*reading.scene);
    };
    const SceneSpec plain = read("");
    CHECK(plain.render.background == Background::studio);
    CHECK(plain.render.has_film());
    CHECK(plain.skin.crease_angle == kCreaseAngle);
    const SceneSpec scene = read(
        "[skin]\ncrease_angle = \"70 deg\"\n[render]\nbackground = \"transparent\"\n"
        "light = { azimuth = \"30 deg\", elevation = \"20 deg\" }\n");
    CHECK(scene.skin.crease_angle == Approx(70 * kPi / 180));
    CHECK(scene.render.background == Background::transparent);
    CHECK_FALSE(scene.render.has_film());
    CHECK(scene.render.light.azimuth == Approx(kPi / 6));
    CHECK(scene.render.light.elevation == Approx(kPi / 9));
}

TEST_CASE("a scene says how finely its skin is divided, or that it is not") {
    const auto rest = [](const std::string& divide) {
        return with(&Parts::rest, "[skin]\ndivide = " + divide + "\n").text();
    };
    const auto longest = [&](const std::string& divide) {
        const SceneFolder scratch;
        const SceneReading reading =
            read_scene(scratch.write("s.toml", rest(divide)), {}, shipped());
        REQUIRE(reading.scene);
        return reading.scene->skin.longest_edge;
    };
    CHECK(SceneSpec().skin.longest_edge == kLongestSkinEdge);
    CHECK(longest("true") == kLongestSkinEdge);
    CHECK_FALSE(longest("false"));
    CHECK(longest("0.5") == 0.5);
    CHECK(longest("2") == 2);
    CHECK(says(mistakes_in(rest("0.01")),
               "11:10: divide = 0.01 is out of range: it must be 0.1 to 10"));
    CHECK(says(mistakes_in(rest("\"fine\"")),
               "11:10: divide must be false or a number of cells, 0.1 to 10, without quotes"));
}

TEST_CASE("angles of the camera are open where the scene does not give them") {
    const auto open = [](const std::string& camera) {
        const SceneFolder scratch;
        const Parts parts = with(&Parts::rest, "[render]\n" + camera + "\n");
        const SceneReading reading =
            read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        REQUIRE(reading.scene);
        const OpenAngles& angles = reading.scene->render.open;
        return std::pair(angles.azimuth, angles.elevation);
    };
    const std::pair both(true, true), none(false, false);
    CHECK(open("") == both);
    CHECK(open("camera = { zoom = 2, orbit = \"90 deg\", target = [0, 0, 0] }") == both);
    CHECK(open("camera = { azimuth = \"auto\", elevation = \"auto\" }") == both);
    CHECK(open("camera = { azimuth = \"20 deg\" }") == std::pair(false, true));
    CHECK(open("camera = { azimuth = \"auto\", elevation = \"20 deg\" }") ==
          std::pair(true, false));
    CHECK(open("camera = { azimuth = 1, elevation = 1 }") == none);
    CHECK(open("camera = { eye = [1, 1, 1], target = [0, 0, 0] }") == none);
    CHECK(open("camera = { keys = [{ at = 0 }, { at = 1, zoom = 2 }] }") == none);
}

TEST_CASE("every shipped material has a look, metal where it is one") {
    const MaterialCatalogue catalogue = material_catalogue(shipped(), {});
    REQUIRE(catalogue.look.size() == catalogue.material.size());
    for (std::size_t n = 0; n < catalogue.material.size(); ++n) {
        const Material& one = catalogue.material[n];
        INFO(one.name);
        REQUIRE(catalogue.look[n]);
        const SurfaceMaterial& look = *catalogue.look[n];
        // Nothing but metal is as heavy and as stiff.
        const bool is_metal = one.density > 2600 && one.young_modulus > 10e9;
        CHECK(look.metallic == (is_metal ? 1 : 0));
        CHECK(look.roughness >= 0.05);
        if (is_metal) CHECK(look.color.minCoeff() > 0.25);  // what a clean metal reflects at least
        if (look.clear > 0.5) CHECK(look.roughness < 0.35);
    }
}

TEST_CASE("a scene's look goes over its material's, and a body has that of its own material") {
    const SceneFolder scratch;
    scratch.write("materials.toml",
                  "[goo]\nyoung_modulus = 1e5\ndensity = 900\n"
                  "look = {color = [1, 0.5, 0], roughness = 0.7, clear = 0.2}\n"
                  "[plain]\nyoung_modulus = 1e5\ndensity = 900\n");
    const auto body = [&](const std::string& material, const std::string& rest = "") {
        Parts parts = with(&Parts::material, "[material]\n" + material);
        parts.rest += rest;
        const SceneReading reading =
            read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return reading.scene->body;
    };
    const auto goo = body("name = \"goo\"\n")[0].look;
    REQUIRE(goo);
    CHECK(goo->color.y() == Approx(0.2140).epsilon(1e-3));
    CHECK(goo->roughness == 0.7);
    CHECK(goo->clear == 0.2);
    const auto over = body("name = \"goo\"\nlook = {roughness = 0.1, metalness = 0.5}\n")[0].look;
    CHECK(over->color == goo->color);
    CHECK(over->roughness == 0.1);
    CHECK(over->metallic == 0.5);
    CHECK_FALSE(body("name = \"plain\"\n")[0].look);
    const std::string custom = "young_modulus = 1e5\ndensity = 900\n";
    CHECK_FALSE(body(custom)[0].look);
    CHECK(body(custom + "look = {color = [1, 1, 1]}\n")[0].look->color == Vec3::Ones());
    const std::string ball = "[[body]]\nfile = \"bar.obj\"\n";
    CHECK(body("name = \"goo\"\n", ball)[1].look->roughness == 0.7);
    CHECK_FALSE(body("name = \"goo\"\n", ball + "material = \"plain\"\n")[1].look);
    CHECK(body("name = \"plain\"\n", ball + "material = \"goo\"\n")[1].look->roughness == 0.7);
    const std::string worn = ball + "material = \"goo\"\nlook = \"material\"\n";
    CHECK(body("name = \"plain\"\n", worn)[1].wears_material);
    CHECK_FALSE(body("name = \"plain\"\n", worn)[0].wears_material);
}

TEST_CASE("an inset has the look of its material, or another, and a colour") {
    const auto inset = [](const std::string& more) {
        const Parts parts = with(&Parts::rest,
                                 "[[inset]]\nname = \"lead\"\nfrom = [0, 0, 0]\n"
                                 "to = [1, 1, 0.5]\n" +
                                     more);
        const SceneFolder scratch;
        const SceneReading reading =
            read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
        INFO(told(reading.mistakes, scratch.path()));
        REQUIRE(reading.scene);
        return reading.scene->work_piece().inset.at(0);
    };
    CHECK(inset("").look->metallic == 1);
    CHECK_FALSE(inset("").color);
    CHECK(inset("look = {roughness = 0.9}\n").look->roughness == 0.9);
    CHECK(inset("color = [1, 0, 0]\n").color == Vec3::UnitX());
}

TEST_CASE("mistakes in looks are told at their places") {
    const std::string head = "[mesh]\nfile = \"bar.obj\"\n";
    Parts both = with(&Parts::mesh, head + "look = \"material\"\ncolor = [1, 0, 0]\n");
    Parts none = with(&Parts::mesh, head + "look = \"material\"\n");
    none.material = "[material]\nyoung_modulus = 1e5\ndensity = 900\n";
    Parts bare = none;
    bare.mesh = head;
    bare.material += "look = {roughness = 0.5}\n";
    check_all({
        {"no table", material("look = \"metal\""), {"5:8: look must be a table, such as look ="}},
        {"too much",
         material("look = {roughness = 2, metalness = -1}"),
         {"roughness = 2", "metalness = -1"}},
        {"a colour beyond", material("look = {color = [2, 0, 0]}"), {"5:17: color = [2, 0, 0]"}},
        {"clear metal", material("look = {metalness = 1, clear = 0.5}"), {"metal lets no light"}},
        {"no such key", material("look = {shiny = 1}"), {"unknown key \"shiny\""}},
        {"no colour", bare, {"look needs \"color\""}},
        {"two looks", both, {"3:8: look = \"material\" excludes a color: give one of them"}},
        {"a material without",
         none,
         {"3:8: look = \"material\", but the material has no look: give it one, such as look ="}},
        {"no such look", with(&Parts::mesh, head + "look = \"gold\"\n"), {"3:8: look"}},
        {"of an inset",
         with(&Parts::rest,
              "[[inset]]\nname = \"lead\"\nfrom = [0, 0, 0]\nto = [1, 1, 0.5]\n"
              "look = {roughness = 2}\nrestitution = 1\n"),
         {"roughness = 2", "restitution applies to the whole body: give it in [material]"}},
        {"a colour of an inset",
         with(&Parts::rest,
              "[[inset]]\nname = \"lead\"\nfrom = [0, 0, 0]\nto = [1, 1, 0.5]\n"
              "color = [0, 2, 0]\n"),
         {"color = [0, 2, 0]: red, green and blue must each be 0 to 1"}},
    });
}

TEST_CASE(
    "a texture lies in the scene's folder, is of a kind that is drawn, and is the only look") {
    const SceneFolder scratch;
    scratch.write("cow.png", "\x89PNG\r\n");
    scratch.write("cow.tga", "no kind that its first bytes tell");
    scratch.write("cow.webp", "RIFF....WEBP");
    const auto read = [&](const std::string& more) {
        const Parts parts = with(&Parts::mesh, "[mesh]\nfile = \"bar.obj\"\n" + more);
        return read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    };
    const auto mistakes = [&](const std::string& more) {
        return told(read(more).mistakes, scratch.path());
    };
    const SceneReading good = read("texture = \"cow.png\"\nfinish = \"metal\"\n");
    REQUIRE(good.scene);
    CHECK(good.scene->work_piece().mesh.texture == scratch.path() / "cow.png");
    CHECK(good.scene->work_piece().is_painted());
    CHECK(read("texture = \"cow.tga\"\n").scene);
    CHECK(says(mistakes("texture = \"cat.png\"\n"),
               "s.toml:3:11: the texture \"cat.png\" does not exist ("));
    CHECK(says(mistakes("texture = \"cow.webp\"\n"),
               "s.toml:3:11: the texture \"cow.webp\" is of type WebP: it must be PNG, JPEG, "
               "BMP or TGA ("));
    CHECK(says(mistakes("texture = \"cow.png\"\ncolor = [1, 0, 0]\n"),
               "s.toml:3:11: texture excludes a color: give one of them"));
    CHECK(says(mistakes("texture = \"cow.png\"\nlook = \"material\"\n"),
               "s.toml:4:8: look = \"material\" excludes a texture: give one of them"));
}

TEST_CASE("a camera follows the bodies, beside keys too, unless it looks elsewhere") {
    const auto read = [](const std::string& camera) {
        const SceneFolder scratch;
        const Parts parts = with(&Parts::rest, "[render.camera]\nfollow = true\n" + camera);
        return read_scene(scratch.write("s.toml", parts.text()), {}, shipped());
    };
    const auto follows = [&](const std::string& camera) {
        const SceneReading reading = read(camera);
        return reading.scene && reading.scene->render.follow;
    };
    CHECK(follows("azimuth = 1\n"));
    CHECK(follows("orbit = \"90 deg\"\nzoom = 2\n"));
    CHECK(follows("keys = [{at = 0, zoom = 1}, {at = 1, zoom = 2}]\n"));
    for (const char* elsewhere : {"target = [0, 0, 0]\n", "eye = [1, 0, 0]\ntarget = [0, 0, 0]\n",
                                  "keys = [{at = 0}, {at = 1, target = [0, 0, 0]}]\n"}) {
        const std::vector<Mistake> mistakes = read(elsewhere).mistakes;
        REQUIRE(mistakes.size() == 1);
        CHECK(says(mistake_text(mistakes[0]),
                   "follow looks at the bodies, and cannot be used with an eye or a target"));
    }
}
