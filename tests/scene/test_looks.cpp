// SPDX-License-Identifier: GPL-3.0-or-later
// How a scene asks to be seen.
#include "tests/scene/bad_scene.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("a scene says where light comes from, what is behind and which edges are sharp") {
    const auto read = [](const std::string& rest) {
        const Scratch scratch;
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

TEST_CASE("angles of the camera are open where the scene does not give them") {
    const auto open = [](const std::string& camera) {
        const Scratch scratch;
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
