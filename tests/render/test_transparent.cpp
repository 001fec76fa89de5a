// SPDX-License-Identifier: GPL-3.0-or-later
// Stills for compositing, and lamps that stand elsewhere.
#include "render/png.h"
#include "tests/render/drawn.h"

using namespace swage;

namespace {

const Pose kStanding = {Quat::Identity(), {0, 0.2, 0}};

Image box_on_ground(RenderSettings settings, bool is_drawn = true) {
    settings.camera[0].elevation = 0.9;
    settings.camera[0].zoom = 2;
    const TriMesh box = box_mesh(0.4);
    std::vector<DrawItem> items;
    if (is_drawn) items.push_back({&box, nullptr, kStanding, colored({0.9, 0.2, 0.1})});
    return drawn(settings, items);
}

}  // namespace

TEST_CASE("a transparent still has the body's colours, the ground's shadow and nothing else",
          "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    const Image studio = box_on_ground(settings);
    CHECK(studio.alpha.empty());
    const Image bare = box_on_ground(settings, false);
    settings.background = Background::transparent;
    const Image clear = box_on_ground(settings), empty = box_on_ground(settings, false);
    REQUIRE(clear.alpha.size() == std::size_t(clear.width * clear.height));
    CHECK(*std::max_element(empty.alpha.begin(), empty.alpha.end()) < 8);
    int body = 0, shadow = 0, edge = 0;
    for (int i = 0; i < clear.width * clear.height; ++i) {
        const std::uint8_t* p = &clear.rgb[3 * i];
        const int alpha = clear.alpha[i];
        if (alpha == 255) {
            ++body;
            for (int c = 0; c < 3; ++c) CHECK(p[c] == studio.rgb[3 * i + c]);
        } else if (p[0] + p[1] + p[2] == 0) {
            shadow += alpha > 29;  // a quarter of the light is kept away
            // Laid over the studio it is the shadow that falls there, but for the blue in it.
            const std::uint8_t *under = &bare.rgb[3 * i], *drawn = &studio.rgb[3 * i];
            const double laid = (under[0] + under[1] + under[2]) * (1 - alpha / 255.0);
            CHECK(std::abs(laid - (drawn[0] + drawn[1] + drawn[2])) < 9);
        } else {
            ++edge;  // the body's own colour, however little of it there is
            CHECK(p[0] > p[2]);
        }
    }
    CHECK(body > 500);
    CHECK(shadow > 100);
    CHECK(edge < body / 2);
    CHECK(clear.alpha[0] < 8);
    CHECK(encode_png(clear)[25] == 6);   // RGBA
    CHECK(encode_png(studio)[25] == 2);  // RGB
}

TEST_CASE("a shadow falls away from where the lamp is put, and farther from a low one",
          "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    settings.background = Background::transparent;
    // Share of the shadow that lies right of the middle, and its area.
    const auto shadow = [&](double azimuth, double elevation) {
        settings.light = {azimuth, elevation};
        const Image image = box_on_ground(settings);
        double right = 0, all = 0;
        for (int i = 0; i < image.width * image.height; ++i) {
            if (image.rgb[3 * i] > 0) continue;
            all += image.alpha[i];
            right += i % image.width >= image.width / 2 ? image.alpha[i] : 0;
        }
        return std::pair(right / all, all);
    };
    CHECK(shadow(-1.5, 0.7).first > 0.8);
    CHECK(shadow(1.5, 0.7).first < 0.2);
    CHECK(shadow(1.5, 0.5).second > 1.3 * shadow(1.5, 1.0).second);
    const LightPlace usual;
    RenderSettings plain = small_picture(), same = small_picture();
    same.light = {usual.azimuth, usual.elevation};
    CHECK(box_on_ground(plain).rgb == box_on_ground(same).rgb);
}
