// SPDX-License-Identifier: GPL-3.0-or-later
// What stands far away, or has no end, leaves the action as it is.
#include "tests/render/drawn.h"

using namespace swage;

namespace {

DrawItem red(const TriMesh& mesh, const Vec3& at) {
    return {&mesh, nullptr, {Quat::Identity(), at}, colored({1, 0, 0})};
}
DrawItem grey(const TriMesh& mesh, const Vec3& at, bool endless = false) {
    return {&mesh, nullptr, {Quat::Identity(), at}, colored({0.5, 0.5, 0.5}), endless};
}

int red_pixels(const Image& image) {
    int count = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t* p = image.pixel(x, y);
            count += p[0] > 2 * p[1] && p[0] > 30;
        }
    }
    return count;
}

}  // namespace

TEST_CASE("what is near the eye is whole, however far other things reach", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.4), slab = surface_of(BoxShape{Vec3(2000, 0.2, 2000), 0});
    RenderSettings settings = small_picture();
    settings.ground = false;
    CameraKey& key = settings.camera[0];
    key.eye = Vec3(0.3, 0.45, 0.3), key.target = Vec3(0.2, 0.4, 0.2);  // a corner of the box
    const DrawItem body = red(box, {0, 0.2, 0});
    const int alone = red_pixels(drawn(settings, {body}));
    REQUIRE(alone > 3000);
    for (const double away : {30.0, 300.0, 3000.0}) {
        CAPTURE(away);
        CHECK(red_pixels(drawn(settings, {body, grey(box, {0, 0, away})})) == alone);
        CHECK(red_pixels(drawn(settings, {body, grey(box, {0, 0, -away})})) == alone);
    }
    settings.ground = true;
    CHECK(red_pixels(drawn(settings, {body, grey(slab, {0, -0.1, 0}, true)})) == alone);
    // Nearer than a part of ten thousand of the action.
    key.eye = Vec3(0, 0.2, 0.201), key.target = Vec3(0, 0.2, 0);
    settings.ground = false;
    CHECK(red_pixels(drawn(settings, {body})) == settings.width * settings.height);
}

TEST_CASE("a tool far away, or very long, takes no shadow from the action", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.3), rail = surface_of(BoxShape{Vec3(400, 0.1, 0.1), 0});
    RenderSettings settings = small_picture();
    settings.camera[0].elevation = 1.2;
    const auto shadow = [&](const std::vector<DrawItem>& far) {
        const Image without = drawn(settings, far);
        std::vector<DrawItem> items = far;
        items.push_back(grey(box, {0, 0.15, 0}));
        const Image with = drawn(settings, items);
        double sum = 0;
        for (int y = 0; y < with.height; ++y) {
            for (int x = 0; x < with.width; ++x) {
                sum += std::max(0.0, brightness(without, x, y) - brightness(with, x, y));
            }
        }
        return sum;
    };
    const double alone = shadow({});
    REQUIRE(alone > 5000);
    for (const double away : {40.0, 400.0, 4000.0}) {
        CAPTURE(away);
        CHECK(shadow({grey(box, {away, 0.15, 0})}) == Approx(alone).epsilon(0.1));
    }
    CHECK(shadow({grey(rail, {0, 0.1, 40})}) == Approx(alone).epsilon(0.1));
}

TEST_CASE("a floor without end that is small beside the action is no bright disc", "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    settings.camera[0].elevation = 1.2;
    // As the project's own floor is coloured.
    const SurfaceMaterial paper = colored({0.52, 0.53, 0.545});
    const auto most_lighter = [&](double side) {
        const TriMesh slab = surface_of(BoxShape{Vec3(side, 0.05 * side, side), 0});
        const Pose under{Quat::Identity(), {0, -0.025 * side, 0}};
        const Image with = drawn(settings, {{&slab, nullptr, under, paper, true}});
        settings.ground = false;
        const Image without = drawn(settings, {});
        settings.ground = true;
        double most = 0;
        for (int y = 0; y < with.height; ++y) {
            for (int x = 0; x < with.width; ++x) {
                most = std::max(most, brightness(with, x, y) - brightness(without, x, y));
            }
        }
        return most;
    };
    for (const double side : {60.0, 0.6, 0.2, 0.05}) {
        const double most = most_lighter(side);
        CAPTURE(side, most);
        CHECK((side > 1 ? most > 10 : most < 3));
    }
}

TEST_CASE("from below a floor without end hides nothing, as the ground does not", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.4), slab = surface_of(BoxShape{Vec3(60, 0.2, 60), 0});
    RenderSettings settings = small_picture();
    settings.camera[0].elevation = -0.4;
    const DrawItem body = red(box, {0, 0.2, 0});
    const int free = red_pixels(drawn(settings, {body}));
    REQUIRE(free > 500);
    CHECK(red_pixels(drawn(settings, {body, grey(slab, {0, -0.1, 0}, true)})) == free);
    // One that ends is a body as any other.
    CHECK(red_pixels(drawn(settings, {body, grey(slab, {0, -0.1, 0})})) == 0);
}
