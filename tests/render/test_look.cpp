// SPDX-License-Identifier: GPL-3.0-or-later
// What surfaces mirror and let through, as the pictures show it.
#include <algorithm>

#include "render/studio.h"
#include "tests/render/drawn.h"

using namespace swage;

namespace {

SurfaceMaterial look_of(const Vec3& color, double roughness, double metallic, double clear = 0) {
    SurfaceMaterial look = colored(color);
    look.roughness = roughness;
    look.metallic = metallic;
    look.clear = clear;
    return look;
}

RenderSettings level_view() {
    RenderSettings settings = small_picture();
    settings.width = 320, settings.height = 240;
    settings.camera[0].azimuth = 0;
    settings.camera[0].elevation = 0.15;
    return settings;
}

struct Ball {
    Image image;
    std::vector<int> item;  // whose each pixel is
    // All that the ball takes within so many pixels of it.
    bool is_inside(int x, int y, int far) const {
        for (const auto& [dx, dy] : {std::pair(far, 0), {-far, 0}, {0, far}, {0, -far}}) {
            if (item[std::size_t((y + dy) * image.width + x + dx)] != 0) return false;
        }
        return true;
    }
};

Ball ball_of(const SurfaceMaterial& look) {
    const TriMesh mesh = surface_of(SphereShape{0.6});
    Renderer renderer(level_view(), kAction, 0);
    Layers layers;
    Ball ball;
    ball.image =
        renderer.draw({{{&mesh, nullptr, {Quat::Identity(), {0, 0.6, 0}}, look}}, 0}, &layers);
    ball.item = layers.item;
    return ball;
}

// Of the ball's pixels but for its rim.
std::array<int, 3> brightest(const Ball& ball) {
    std::array<int, 3> most{};
    for (int y = 8; y < ball.image.height - 8; ++y) {
        for (int x = 8; x < ball.image.width - 8; ++x) {
            const std::uint8_t* p = ball.image.pixel(x, y);
            if (!ball.is_inside(x, y, 8) || p[0] + p[1] + p[2] <= most[0] + most[1] + most[2])
                continue;
            most = {p[0], p[1], p[2]};
        }
    }
    return most;
}

// Least and greatest brightness in the middle of a plate that faces the camera.
std::array<double, 2> range_on_plate(const SurfaceMaterial& look) {
    const TriMesh plate = surface_of(BoxShape{Vec3(1.6, 1.0, 0.1), 0});
    const Image image =
        drawn(level_view(), {{&plate, nullptr, {Quat::Identity(), {0, 0.5, 0}}, look}});
    std::array<double, 2> range = {255, 0};
    for (int y = 90; y < 150; ++y) {
        for (int x = 90; x < 230; ++x) {
            range[0] = std::min(range[0], brightness(image, x, y));
            range[1] = std::max(range[1], brightness(image, x, y));
        }
    }
    return range;
}

}  // namespace

TEST_CASE("a flat face of metal shows a gradient, of matt stuff hardly one", "[renderer]") {
    if (!can_draw()) return;
    const auto metal = range_on_plate(look_of({0.56, 0.57, 0.58}, 0.3, 1));
    const auto matt = range_on_plate(look_of({0.56, 0.57, 0.58}, 1, 0));
    INFO("metal " << metal[0] << " to " << metal[1] << ", matt " << matt[0] << " to " << matt[1]);
    CHECK(metal[1] - metal[0] > 30);
    CHECK(matt[1] - matt[0] < 15);
    CHECK(metal[0] > 40);  // no face is black
}

TEST_CASE("a metal's highlight has the metal's colour, that of paint is white", "[renderer]") {
    if (!can_draw()) return;
    const Vec3 color(0.30, 0.12, 0.06);
    const auto metal = brightest(ball_of(look_of(color, 0.35, 1)));
    const auto paint = brightest(ball_of(look_of(color, 0.1, 0)));
    const auto matt = brightest(ball_of(look_of(color, 1, 0)));
    const auto blue_of_red = [](const std::array<int, 3>& c) { return double(c[2]) / c[0]; };
    INFO("blue over red: metal " << blue_of_red(metal) << ", paint " << blue_of_red(paint)
                                 << ", matt " << blue_of_red(matt));
    CHECK(blue_of_red(metal) < 0.6);
    CHECK(blue_of_red(paint) > 1.2 * blue_of_red(matt));
}

TEST_CASE("the smoother a surface is, the brighter its highlight; a rough one has none",
          "[renderer]") {
    if (!can_draw()) return;
    const Vec3 dark(0.05, 0.05, 0.05);
    double before = 1e9;
    for (const double roughness : {0.1, 0.3, 0.5, 0.75, 1.0}) {
        const auto top = brightest(ball_of(look_of(dark, roughness, 0)));
        INFO("roughness " << roughness << ": " << top[0]);
        CHECK(top[0] < before);
        before = top[0];
    }
    const auto without = brightest(ball_of(look_of(dark, 1, 0)));
    const auto black = brightest(ball_of(look_of({0, 0, 0}, 1, 0)));
    CHECK(without[0] - black[0] > black[0] / 4);  // what it shows is mostly its own colour
}

TEST_CASE("a clear ball shows the room upside down and no shade of its own", "[renderer]") {
    if (!can_draw()) return;
    const auto rows = [](const Ball& ball) {  // of the middle column, that it takes
        std::array<int, 2> ends = {ball.image.height, 0};
        for (int y = 0; y < ball.image.height; ++y) {
            if (ball.item[std::size_t(y * ball.image.width + ball.image.width / 2)] != 0) continue;
            ends = {std::min(ends[0], y), std::max(ends[1], y)};
        }
        return ends;
    };
    const auto top_over_bottom = [&](const Ball& ball) {
        const auto [top, bottom] = rows(ball);
        const int off = (bottom - top) / 6, x = ball.image.width / 2;
        return brightness(ball.image, x, top + off) / brightness(ball.image, x, bottom - off);
    };
    const Ball glass = ball_of(look_of({0.9, 0.9, 0.9}, 0.1, 0, 1)),
               plaster = ball_of(look_of({0.9, 0.9, 0.9}, 0.9, 0));
    INFO("top over bottom: glass " << top_over_bottom(glass) << ", plaster "
                                   << top_over_bottom(plaster));
    CHECK(top_over_bottom(plaster) > 1.2);
    CHECK(top_over_bottom(glass) < top_over_bottom(plaster) / 1.2);
    // Tinted by what it goes through.
    const Ball red = ball_of(look_of({0.9, 0.2, 0.2}, 0.1, 0, 1));
    const auto [top, bottom] = rows(red);
    const std::uint8_t* p = red.image.pixel(red.image.width / 2, (top + bottom) / 2);
    CHECK(p[0] > p[2] + 40);
}

TEST_CASE("a floor of the backdrop's paper looks as the ground does", "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    const TriMesh slab = surface_of(BoxShape{Vec3(60, 0.2, 60), 0});
    const TriMesh box = box_mesh(0.4);
    const DrawItem body{&box, nullptr, {Quat::Identity(), {0, 0.2, 0}}, colored({0.8, 0.3, 0.1})};
    const DrawItem floor{
        &slab, nullptr, {Quat::Identity(), {0, -0.1, 0}}, colored({0.52, 0.53, 0.545}), true};
    const Image a = drawn(settings, {body}), b = drawn(settings, {floor, body});
    double apart = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) apart += std::abs(a.rgb[i] - b.rgb[i]);
    apart /= double(a.rgb.size());
    INFO("apart by " << apart << " of 255");
    CHECK(apart < 2);
}

TEST_CASE("a plate that mirrors what lies right opposite a lamp shows no spark", "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = level_view();
    settings.width = 640, settings.height = 480;
    const TriMesh plate = surface_of(BoxShape{Vec3(1.6, 1.6, 0.02), 0});
    const Lamps lamps = lamps_of(settings.light, 0);
    for (const Vec3& lamp : {lamps.key, lamps.fill, lamps.rim, Vec3(-0.436, 0, 0.9)}) {
        // The room keeps to the first view; from the second the plate mirrors what we want.
        const double azimuth = std::atan2(-lamp.x(), -lamp.z()) + 0.8;
        settings.camera = {{0, 0.0, 0.15, 1, {}, {}}, {1, azimuth, 0.15, 1, {}, {}}};
        const Vec3 eye(std::cos(0.15) * std::sin(azimuth), std::sin(0.15),
                       std::cos(0.15) * std::cos(azimuth));
        const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), (eye - lamp).normalized());
        Renderer renderer(settings, kAction, -1);
        Layers layers;
        const Image image = renderer.draw(
            {{{&plate, nullptr, {turn, {0, 0.5, 0}}, look_of({0.6, 0.6, 0.6}, 0.3, 1)}}, 1},
            &layers);
        double most = 0;
        int seen = 0;
        for (int y = 9; y < image.height - 9; ++y) {
            for (int x = 9; x < image.width - 9; ++x) {
                double about = 0;
                bool is_inside = true;
                for (const auto& [dx, dy] : {std::pair(6, 0), {0, 6}, {6, 6}, {6, -6}}) {
                    for (const int sign : {-1, 1}) {
                        const int i = x + sign * dx, j = y + sign * dy;
                        about = std::max(about, brightness(image, i, j));
                        is_inside &= layers.item[std::size_t(j * image.width + i)] == 0;
                    }
                }
                if (!is_inside) continue;
                ++seen;
                most = std::max(most, brightness(image, x, y) - about);
            }
        }
        INFO("lamp at " << lamp.transpose() << ": brighter than all about it by " << most);
        CHECK(seen > 10000);
        CHECK(most < 8);
    }
}

TEST_CASE("colours that tell numbers are the scale's in light and in shade", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh ball = surface_of(SphereShape{0.4});
    const Vec3 color(0.1, 0.35, 0.4);
    const auto darkest_share = [&](bool tells_numbers) {
        DrawItem item{&ball, nullptr, {Quat::Identity(), {0, 0.5, 0}}, colored(color)};
        item.material_override->roughness = 0.85;
        item.tells_numbers = tells_numbers;
        const Image image = drawn(small_picture(), {item});
        double least = 255, most = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* p = image.pixel(x, y);
                if (p[2] < p[0] + 20) continue;
                least = std::min(least, brightness(image, x, y));
                most = std::max(most, brightness(image, x, y));
            }
        }
        return least / most;
    };
    const double as_it_looks = darkest_share(false), as_a_scale = darkest_share(true);
    INFO("the darkest has " << as_it_looks << " and " << as_a_scale << " of the brightest");
    CHECK(as_it_looks < 0.5);
    CHECK(as_a_scale > 0.55);
}
