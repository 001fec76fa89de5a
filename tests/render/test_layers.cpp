// SPDX-License-Identifier: GPL-3.0-or-later
// Depth, normals and whose each pixel is, for compositing.
#include <cstring>
#include <map>
#include <random>

#include "base/process.h"
#include "geometry/box_mesh.h"
#include "render/camera.h"
#include "render/exr.h"
#include "render/layers.h"
#include "tests/render/drawn.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

// From the eye at z = 5 along -z.
RenderSettings from_ahead() {
    RenderSettings settings = small_picture();
    settings.ground = false;
    settings.camera[0].eye = Vec3(0, 0, 5);
    settings.camera[0].target = Vec3(0, 0, 0);
    return settings;
}

Layers layers_drawn(const RenderSettings& settings, const std::vector<DrawItem>& items,
                    Image* still = nullptr) {
    Renderer renderer(settings, kAction, 0);
    Layers layers;
    Image image = renderer.draw({items, 0}, &layers);
    if (still != nullptr) *still = std::move(image);
    return layers;
}

// Through the middle of a pixel of a small picture; 1 deep.
Vec3 sight_through(const View& view, const Lens& lens, int x, int y) {
    return view.world_from_view *
           Vec3(lens.tangent_x * ((x + 0.5) / 80 - 1), lens.tangent_y * (1 - (y + 0.5) / 60), -1);
}

}  // namespace

TEST_CASE("the depth of what stands at a known distance is that, and beside it nothing is") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(Vec3(-0.4, -0.3, -0.25), Vec3(0.4, 0.3, 0.25));
    const double ahead = GENERATE(0.0, 0.37, -2.0);
    const Layers layers =
        layers_drawn(from_ahead(), {{&box, nullptr, {Quat::Identity(), {0, 0, ahead}}, {}}});
    REQUIRE(layers.width == 160);
    REQUIRE(layers.depth.size() == std::size_t(160) * 120);
    const double front = 5 - ahead - 0.5 * 0.5;
    int seen = 0;
    for (std::size_t i = 0; i < layers.depth.size(); ++i) {
        if (layers.item[i] == kNothingThere) {
            CHECK(layers.depth[i] == kNoDepth);
            CHECK(layers.normal[i].norm() == 0);
            continue;
        }
        ++seen;
        REQUIRE(layers.item[i] == 0);
        CHECK(layers.depth[i] == Approx(front).margin(1e-5));
        CHECK((layers.normal[i] - Eigen::Vector3f::UnitZ()).norm() < 1e-5);
    }
    // As many pixels as its front takes, and those in the middle.
    const double tall = 0.6 / front / (2 * std::tan(0.5 * small_picture().field_of_view)) * 120;
    const double wide = tall * 0.8 / 0.6;
    CHECK(seen == Approx(tall * wide).epsilon(0.08));
    CHECK(layers.item[60 * 160 + 80] == 0);
}

TEST_CASE("depth goes along the view, whatever the direction, also on the ground") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    settings.camera[0].eye = Vec3(1, 3, 4);
    settings.camera[0].target = Vec3(0.2, 0.1, 0);
    const View view = look_at(*settings.camera[0].eye, *settings.camera[0].target);
    const Layers layers = layers_drawn(settings, {});
    const Lens lens = lens_of(settings);
    int seen = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            const std::size_t i = std::size_t(y) * 160 + x;
            const Vec3 sight = sight_through(view, lens, x, y);
            const double depth = -view.eye.y() / sight.y();
            if (layers.item[i] != kGroundThere) continue;
            ++seen;
            CHECK(layers.depth[i] == Approx(depth).epsilon(1e-5));
            CHECK((layers.normal[i] - Eigen::Vector3f::UnitY()).norm() < 1e-5);
        }
    }
    CHECK(seen > 15000);
}

TEST_CASE("ground and endless floors go on to the horizon, which is level") {
    if (!can_draw()) return;
    const TriMesh slab = box_mesh(Vec3(-8, -0.2, -8), Vec3(8, 0, 8));
    RenderSettings settings = small_picture();
    const bool is_floor = GENERATE(false, true);
    settings.camera[0].eye = Vec3(3, 1, 4);  // aslant to the floor's edges
    settings.camera[0].target = Vec3(0, 0.4, 0);
    const View view = look_at(*settings.camera[0].eye, *settings.camera[0].target);
    const Lens lens = lens_of(settings);
    std::vector<DrawItem> items;
    if (is_floor) items.push_back({&slab, nullptr, {}, std::nullopt, true});
    const Layers layers = layers_drawn(settings, items);
    int above = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            const std::size_t i = std::size_t(y) * 160 + x;
            const Vec3 sight = sight_through(view, lens, x, y);
            if (sight.y() > -1e-3) {
                ++above;
                if (sight.y() > 1e-3) CHECK(layers.item[i] == kNothingThere);
                continue;
            }
            REQUIRE(layers.item[i] == (is_floor ? 0 : kGroundThere));
            CHECK(layers.depth[i] == Approx(-view.eye.y() / sight.y()).epsilon(1e-3));
            CHECK((layers.normal[i] - Eigen::Vector3f::UnitY()).norm() < 1e-5);
        }
    }
    CHECK(above > 160 * 10);
    CHECK(above < 160 * 110);
}

TEST_CASE("each pixel is one item's, the nearest, and a still is the same with them") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(Vec3::Constant(-0.25), Vec3::Constant(0.25));
    const TriMesh ball = surface_of(SphereShape{0.3});
    const std::vector<DrawItem> items = {{&box, nullptr, {Quat::Identity(), {-0.3, 0.3, 0}}, {}},
                                         {&ball, nullptr, {Quat::Identity(), {0.1, 0.3, 0.6}}, {}}};
    RenderSettings settings = from_ahead();
    settings.ground = true;
    settings.camera[0].eye = Vec3(0, 1, 5);
    Image with;
    const Layers layers = layers_drawn(settings, items, &with);
    std::map<int, int> count;
    for (const int item : layers.item) ++count[item];
    CHECK(count[0] > 200);
    CHECK(count[1] > 200);
    CHECK(count[kGroundThere] > 200);
    CHECK(count[0] + count[1] + count[kGroundThere] + count[kNothingThere] == 160 * 120);
    CHECK(drawn(settings, items).rgb == with.rgb);
    const Layers alone = layers_drawn(settings, {items[0]});
    int hidden = 0;
    for (std::size_t i = 0; i < layers.item.size(); ++i) {
        CHECK(layers.depth[i] <= alone.depth[i] * (1 + 1e-6f));
        hidden += alone.item[i] == 0 && layers.item[i] == 1;
        // A ball's normals point away from its middle: the ones that are seen lean to the eye.
        if (layers.item[i] == 1) CHECK(layers.normal[i].norm() == Approx(1).margin(1e-4));
    }
    CHECK(hidden > 50);
}

TEST_CASE("a normal comes back from its octahedron, folded or not") {
    std::mt19937 random(3);
    std::normal_distribution<float> any;
    std::vector<Eigen::Vector3f> normal;
    std::vector<float> rgba;
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3f n =
            Eigen::Vector3f(any(random), any(random), any(random)).normalized();
        const Eigen::Vector2f flat = n.head<2>() / n.lpNorm<1>();
        const Eigen::Vector2f sign((n.x() >= 0) ? 1 : -1, (n.y() >= 0) ? 1 : -1);
        const Eigen::Vector2f folded =
            (Eigen::Vector2f::Ones() - flat.reverse().cwiseAbs()).cwiseProduct(sign);
        const Eigen::Vector2f at = n.z() >= 0 ? flat : folded;
        normal.push_back(n);
        rgba.insert(rgba.end(), {at.x(), at.y(), 1.0f, layer_number(0)});
    }
    const Layers layers = layers_of(1, 200, rgba, 1);
    for (std::size_t i = 0; i < 200; ++i) {
        CHECK((layers.normal[199 - i] - normal[i]).norm() < 1e-5);
    }
}

TEST_CASE("a file of floats is read by another program as what was written") {
    if (!program_exists("ffmpeg")) {
        WARN("skipped: no ffmpeg");
        return;
    }
    const Scratch scratch;
    // Not full blocks of rows, smooth and rough values, large and less than nothing.
    const int width = 37, height = GENERATE(1, 16, 43);
    std::mt19937 random(7);
    std::vector<ExrChannel> channels = {{"normal.Y", {}}, {"normal.X", {}}, {"normal.Z", {}}};
    for (int i = 0; i < width * height; ++i) {
        channels[0].value.push_back(0.25f * float(i % width));
        channels[1].value.push_back(std::uniform_real_distribution<float>(-1, 1)(random));
        channels[2].value.push_back(i % 5 == 0 ? 1e10f : -1.0f / 3);
    }
    const std::string bytes = encode_exr(width, height, channels);
    scratch.write("x.exr", bytes);
    const std::string command = fmt::format(
        "ffmpeg -v error -layer normal -i {0}/x.exr -f rawvideo -pix_fmt gbrpf32le {0}/x.raw",
        scratch.path().string());
    CHECK(std::system(command.c_str()) == 0);
    const std::string raw = test::bytes_of(scratch / "x.raw");
    const std::size_t plane = std::size_t(width) * height;
    REQUIRE(raw.size() == 3 * plane * sizeof(float));
    // Green, blue and red are y, z and x.
    const std::size_t of_plane[] = {0, 2, 1};
    for (std::size_t p = 0; p < 3; ++p) {
        const std::vector<float>& value = channels[of_plane[p]].value;
        CHECK(std::memcmp(raw.data() + p * plane * sizeof(float), value.data(),
                          plane * sizeof(float)) == 0);
    }
}
