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
