// SPDX-License-Identifier: GPL-3.0-or-later
// Shadows of what is small in the action, of what reaches far, and through narrow gaps.
#include <functional>
#include <iterator>

#include "tests/render/drawn.h"

using namespace swage;

namespace {

DrawItem red(const TriMesh& mesh, const Vec3& at) {
    return {&mesh, nullptr, {Quat::Identity(), at}, colored({0.8, 0.05, 0.05})};
}

bool is_red(const Image& image, int x, int y) {
    const std::uint8_t* p = image.pixel(x, y);
    return p[0] > 2 * p[1];
}

// How much darker the ground is than without the bodies, a share; below 0: no ground.
std::vector<double> darkening(const RenderSettings& settings, const std::vector<DrawItem>& items,
                              const Box& action, Image* seen = nullptr) {
    const Image with = drawn(settings, items, 0, action), without = drawn(settings, {}, 0, action);
    std::vector<double> share;
    for (int y = 0; y < with.height; ++y) {
        for (int x = 0; x < with.width; ++x) {
            const double dimmed = 1 - brightness(with, x, y) / brightness(without, x, y);
            share.push_back(is_red(with, x, y) ? -1 : std::max(dimmed, 0.0));
        }
    }
    if (seen != nullptr) *seen = with;
    return share;
}

}  // namespace

TEST_CASE("a small body's shadow and creases are the same, however far others are", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh ball = surface_of(SphereShape{0.05});
    RenderSettings settings = small_picture();
    settings.width = 320, settings.height = 240;
    settings.camera[0].eye = Vec3(0.1, 0.2, 0.4), settings.camera[0].target = Vec3(0, 0.05, 0);
    const Box own{{-0.05, 0, -0.05}, {0.05, 0.1, 0.05}};
    Image near_by;
    const std::vector<double> alone = darkening(settings, {red(ball, {0, 0.05, 0})}, own, &near_by);
    for (const Vec3& away : {Vec3(3, 0, 0), Vec3(0, 0, -15), Vec3(40, 0, 0), Vec3(0, 0, -300)}) {
        Box action = own;
        action.grow(Box{own.low + away, own.high + away});
        const std::vector<DrawItem> items = {red(ball, {0, 0.05, 0}),
                                             red(ball, Vec3(0, 0.05, 0) + away)};
        Image picture;
        const std::vector<double> both = darkening(settings, items, action, &picture);
        double shadow = 0, apart = 0, body = 0, body_apart = 0;
        for (int y = 0; y < picture.height; ++y) {
            for (int x = 0; x < picture.width; ++x) {
                const auto i = std::size_t(y * picture.width + x);
                if (alone[i] >= 0 && both[i] >= 0) {
                    shadow += alone[i];
                    apart += std::abs(both[i] - alone[i]);
                } else if (is_red(near_by, x, y) && is_red(picture, x, y)) {
                    body += 1;
                    body_apart += std::abs(brightness(near_by, x, y) - brightness(picture, x, y));
                }
            }
        }
        INFO("away by " << away.transpose() << ": shadow differs by " << apart / shadow
                        << " of it, body by " << body_apart / body << " of 255");
        CHECK(apart < 0.3 * shadow);
        CHECK(body_apart < 4 * body);
    }
}

TEST_CASE("along a long shadow no seam shows where one map ends", "[renderer]") {
    if (!can_draw()) return;
    // A rail that runs away from the eye, and the middle of its shadow beside it.
    const TriMesh rail = surface_of(BoxShape{Vec3(0.2, 0.1, 200), 0});
    const Box action{{-0.1, 0, -200}, {0.1, 0.3, 0}};
    RenderSettings settings = small_picture();
    settings.width = 480, settings.height = 360;
    settings.light.azimuth = -1.2, settings.light.elevation = 1.1;
    settings.camera[0].eye = Vec3(0.3, 1.2, 0.3), settings.camera[0].target = Vec3(0.2, 0.2, -4);
    const std::vector<double> share = darkening(settings, {red(rail, {0, 0.25, -100})}, action);
    std::vector<double> middle;  // of each row, from below, as far as the shadow is not a line
    for (int y = settings.height - 1; y >= 0; --y) {
        std::vector<double> dark;
        const auto row = share.begin() + y * settings.width;
        std::copy_if(row, row + settings.width, std::back_inserter(dark),
                     [](double d) { return d > 0.2; });
        if (dark.size() < 8) break;
        std::nth_element(dark.begin(), dark.begin() + 4, dark.end(), std::greater<>());
        middle.push_back(dark[4]);  // where edges of the rail are mixed in it is darker yet
    }
    double step = 0;
    const std::size_t rows = middle.size();
    for (std::size_t i = 4; i < rows; ++i) {
        step = std::max(step, std::abs(middle[i] - middle[i - 4]));
    }
    INFO("steps of up to " << step << " in " << rows << " rows");
    CHECK(rows > 200);
    CHECK(step < 0.04);
}

TEST_CASE("shadows of many thin things high above the ground are smooth", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh slat = surface_of(BoxShape{Vec3(0.03, 0.01, 1.2), 0});
    std::vector<DrawItem> items;
    for (int i = -8; i <= 8; ++i) items.push_back(red(slat, {0.09 * i, 0.95 - 0.04 * (i & 3), 0}));
    RenderSettings settings = small_picture();
    settings.width = 960, settings.height = 540;
    settings.camera[0].elevation = 0.5;
    const std::vector<double> share = darkening(settings, items, kAction);
    const auto at = [&](int x, int y) { return share[std::size_t(y * settings.width + x)]; };
    // Against the mean of neighbours four pixels off, where all of these are in shadow.
    double rough = 0, count = 0, most = 0;
    for (int y = 20; y < settings.height - 20; ++y) {
        for (int x = 20; x < settings.width - 20; ++x) {
            bool inside = true;
            double around = 0;
            for (const auto& [dx, dy] : {std::pair{6, 0}, {-6, 0}, {0, 6}, {0, -6}}) {
                inside = inside && at(x + dx, y + dy) > 0.03;
                around += 0.25 * at(x + dx, y + dy);
            }
            if (!inside || at(x, y) < 0.03) continue;
            count += 1;
            most = std::max(most, at(x, y));
            rough += std::abs(at(x, y) - around);
        }
    }
    INFO("rough by " << rough / count << " of " << most << " at " << count << " pixels");
    CHECK(count > 10000);
    CHECK(rough < 0.01 * count);
}
