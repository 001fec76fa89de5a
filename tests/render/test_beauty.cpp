// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a still, before it is made the picture's colours.
#include <cmath>

#include "tests/render/drawn.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

struct Lit {
    Image still;
    Layers layers;

    Eigen::Vector4f light(int x, int y) const {
        const float* at =
            &layers.beauty[4 * (std::size_t(y) * std::size_t(layers.width) + std::size_t(x))];
        return {at[0], at[1], at[2], at[3]};
    }
    // Nothing ends in this pixel or beside it, no triangle either.
    bool is_inside(int x, int y) const {
        if (x < 1 || y < 1 || x + 1 >= layers.width || y + 1 >= layers.height) return false;
        for (int k = 0; k < 9; ++k) {
            const int bx = x + k % 3 - 1, by = y + k / 3 - 1;
            if (item(bx, by) != item(x, y) || triangle(bx, by) != triangle(x, y)) return false;
        }
        return true;
    }
    int triangle(int x, int y) const {
        return layers.triangle[std::size_t(y) * std::size_t(layers.width) + std::size_t(x)];
    }
    int item(int x, int y) const {
        return layers.item[std::size_t(y) * std::size_t(layers.width) + std::size_t(x)];
    }
};

RenderSettings with_beauty() {
    RenderSettings settings = small_picture();
    settings.passes = {PicturePass::beauty, PicturePass::piece};
    return settings;
}

Lit lit(const RenderSettings& settings, const std::vector<DrawItem>& items) {
    Renderer renderer(settings, kAction, 0);
    Lit lit;
    lit.still = renderer.draw({items, 0}, &lit.layers);
    REQUIRE(lit.layers.beauty.size() == lit.layers.item.size() * 4);
    return lit;
}

// shaders/film.glsl, by the standard's own power instead of roots.
std::array<double, 3> shown(const Eigen::Vector4f& light) {
    double c[3] = {light[0], light[1], light[2]};
    const double knee = 0.62, peak = std::max({c[0], c[1], c[2]});
    if (peak > knee) {
        const double over = (peak - knee) / (1 - knee);
        const double bent = 1 - (1 - knee) / (1 + over * (1 + over * (0.5 + 0.2 * over)));
        const double pale = 1 - 1 / (0.18 * (peak - bent) + 1);
        for (double& one : c) one = one * (bent / peak) * (1 - pale) + bent * pale;
    }
    std::array<double, 3> byte{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double s = c[k] <= 0.0031308 ? 12.92 * c[k]
                                           : 1.055 * std::pow(std::min(c[k], 1.0), 1 / 2.4) - 0.055;
        byte[k] = 255 * (s + 0.18 * (s * s * (3 - 2 * s) - s));
    }
    return byte;
}

SurfaceMaterial metal() {
    SurfaceMaterial material = colored({0.9, 0.9, 0.9});
    material.metallic = 1;
    material.roughness = 0.2;
    return material;
}

}  // namespace

TEST_CASE("a still is its light, developed: to a rounding, wherever nothing ends in a pixel") {
    if (!can_draw()) return;
    const TriMesh ball = test::sphere_mesh(0.3, 1);
    const bool is_clear = GENERATE(false, true);
    RenderSettings settings = with_beauty();
    if (is_clear) settings.background = Background::transparent;
    const std::vector<DrawItem> items = {
        {&ball, nullptr, {Quat::Identity(), {-0.4, 0.3, 0}}, colored({0.7, 0.3, 0.05})},
        {&ball, nullptr, {Quat::Identity(), {0.4, 0.3, 0}}, metal()}};
    const Lit now = lit(settings, items);
    int seen = 0, on_bodies = 0;
    float most = 0;
    for (int y = 0; y < now.layers.height; ++y) {
        for (int x = 0; x < now.layers.width; ++x) {
            most = std::max(most, now.light(x, y).head<3>().maxCoeff());
            if (!now.is_inside(x, y) || (is_clear && now.item(x, y) < 0)) continue;
            ++seen;
            on_bodies += now.item(x, y) >= 0;
            const Eigen::Vector4f light = now.light(x, y);
            REQUIRE(light[3] == 1);
            const std::array<double, 3> byte = shown(light);
            for (std::size_t c = 0; c < 3; ++c) {
                INFO(x << " " << y << " " << c << " " << light[c]);
                // Half a unit of rounding, half of the pattern that is laid over it, some for
                // halves and the roots of the curve.
                REQUIRE(std::abs(byte[c] - now.still.pixel(x, y)[c]) < 1.15);
            }
        }
    }
    CHECK(on_bodies > 80);
    if (!is_clear) CHECK(seen > 14000);
    CHECK(most > 1.5);  // what a metal mirrors of a lamp is no longer white
    CHECK(drawn(settings, items).rgb == now.still.rgb);
}

TEST_CASE("light has the still's alpha, by which it is multiplied, and none where nothing is") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.5);
    RenderSettings settings = with_beauty();
    settings.ground = false;
    settings.background = Background::transparent;
    const Pose turned{Quat(Eigen::AngleAxisd(0.4, Vec3::UnitZ())), {0, 0.5, 0}};
    const Lit now = lit(settings, {{&box, nullptr, turned, colored({0.6, 0.6, 0.6})}});
    int partly = 0;
    for (int y = 1; y + 1 < now.layers.height; ++y) {
        for (int x = 1; x + 1 < now.layers.width; ++x) {
            const Eigen::Vector4f light = now.light(x, y);
            const int alpha = now.still.alpha[std::size_t(y) * 160 + std::size_t(x)];
            CHECK(std::abs(255 * light[3] - float(alpha)) < 0.6f);
            if (alpha == 0) CHECK(light.head<3>() == Eigen::Vector3f::Zero());
            if (alpha == 0 || alpha == 255) continue;
            ++partly;
            float brightest = 0;  // of what lies around
            for (int k = 0; k < 9; ++k) {
                const Eigen::Vector4f beside = now.light(x + k % 3 - 1, y + k / 3 - 1);
                if (beside[3] == 1) brightest = std::max(brightest, beside.head<3>().maxCoeff());
            }
            if (brightest > 0) {
                CHECK(light.head<3>().maxCoeff() < 1.25f * light[3] * brightest + 0.02f);
            }
        }
    }
    CHECK(partly > 60);
}

TEST_CASE("laid over the light of the empty studio, light without it is that of the whole one") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.5);
    const std::vector<DrawItem> items = {
        {&box, nullptr, {Quat::Identity(), {0, 0.25, 0}}, colored({0.6, 0.6, 0.6})}};
    RenderSettings settings = with_beauty();
    const Lit whole = lit(settings, items), empty = lit(settings, {});
    settings.background = Background::transparent;
    const Lit clear = lit(settings, items);
    int shaded = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            if (!whole.is_inside(x, y)) continue;
            const Eigen::Vector4f over =
                clear.light(x, y) + (1 - clear.light(x, y)[3]) * empty.light(x, y);
            const float most = (over - whole.light(x, y)).head<3>().cwiseAbs().maxCoeff();
            INFO(x << " " << y);
            CHECK(most < 0.04f * whole.light(x, y).head<3>().maxCoeff() + 2e-3f);
            shaded += clear.item(x, y) == kGroundThere && clear.light(x, y)[3] > 0.15f;
        }
    }
    CHECK(shaded > 100);
}

TEST_CASE("without the pass no light is kept") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    settings.passes = {PicturePass::depth};
    Renderer renderer(settings, kAction, 0);
    Layers layers;
    renderer.draw({}, &layers);
    CHECK(layers.beauty.empty());
    CHECK(layers.triangle.empty());
}
