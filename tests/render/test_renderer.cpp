// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures are compared with tolerance: their bytes differ between processors and versions of Mesa.
#include <filesystem>
#include <thread>

#include "base/srgb.h"
#include "render/draw_mesh.h"
#include "render/png.h"
#include "tests/render/drawn.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

// A square in the plane z = 0 that faces +z, with texture coordinates 0 to 1.
TriMesh square(double side) {
    TriMesh mesh;
    const double h = 0.5 * side;
    mesh.position = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
    mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
    mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangle_uv = mesh.triangle;
    return mesh;
}

double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
    return sum / static_cast<double>(a.rgb.size());
}

}  // namespace

TEST_CASE("OSMesa and EGL draw the same picture", "[renderer]") {
    if (!can_draw(GlProviderKind::osmesa) || !can_draw(GlProviderKind::egl)) return;
    RenderSettings settings = small_picture();
    const TriMesh box = box_mesh(0.8);
    const std::vector<DrawItem> items = {
        {&box, nullptr, {Quat::Identity(), {0, 0.5, 0}}, colored({0.7, 0.2, 0.1})}};
    settings.gl = GlProviderKind::osmesa;
    const Image a = drawn(settings, items);
    settings.gl = GlProviderKind::egl;
    const Image b = drawn(settings, items);
    CHECK(mean_difference(a, b) < 0.5);
}

TEST_CASE("the same picture twice has the same bytes, in any thread", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.8);
    const std::vector<DrawItem> items = {{&box, nullptr, {Quat::Identity(), {0, 0.5, 0}}, {}}};
    const Image here = drawn(small_picture(), items);
    Image there;
    std::thread([&] { there = drawn(small_picture(), items); }).join();
    CHECK((here.rgb == there.rgb));
}

TEST_CASE("a picture of nothing is a smooth backdrop", "[renderer]") {
    if (!can_draw()) return;
    for (const bool ground : {false, true}) {
        RenderSettings settings = small_picture();
        settings.ground = ground;
        const Image image = drawn(settings, {});
        for (int y = 1; y < image.height; ++y) {
            for (int x = 1; x < image.width; ++x) {
                REQUIRE(std::abs(brightness(image, x, y) - brightness(image, x - 1, y)) < 3);
                REQUIRE(std::abs(brightness(image, x, y) - brightness(image, x, y - 1)) < 4);
            }
        }
    }
    Renderer nowhere(small_picture(), Box{}, 0);
    CHECK(nowhere.draw({}).rgb.size() == 160u * 120u * 3u);
}

TEST_CASE("an endless floor has no edge, and takes shadows as the ground does", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.4), slab = surface_of(BoxShape{Vec3(60, 0.2, 60), 0});
    RenderSettings settings = small_picture();
    settings.camera[0].elevation = 0.2;
    const auto floor_that = [&](bool ends) {
        return DrawItem{
            &slab, nullptr, {Quat::Identity(), {0, -0.1, 0}}, colored({0.5, 0.5, 0.5}), !ends};
    };
    const auto steepest = [&](const Image& image) {
        double most = 0;
        for (int y = 1; y < image.height; ++y) {
            most =
                std::max(most, std::abs(brightness(image, 80, y) - brightness(image, 80, y - 1)));
        }
        return most;
    };
    const double edge = steepest(drawn(settings, {floor_that(true)})),
                 none = steepest(drawn(settings, {floor_that(false)}));
    INFO("steps of brightness " << edge << " and " << none);
    CHECK(edge > 10);
    CHECK(none < 0.4 * edge);

    settings.camera[0].elevation = 1.2;
    const DrawItem body{&box, nullptr, {Quat::Identity(), {0, 0.2, 0}}, colored({1, 1, 1})};
    const Image without = drawn(settings, {floor_that(false)});
    const Image with = drawn(settings, {floor_that(false), body});
    int darker = 0;
    for (int y = 0; y < with.height; ++y) {
        for (int x = 0; x < with.width; ++x) {
            darker += brightness(with, x, y) - brightness(without, x, y) < -25;
        }
    }
    CHECK(darker > 80);
}

TEST_CASE("a texture's colours come through as if the surface had them", "[renderer]") {
    if (!can_draw()) return;
    const Scratch scratch;
    const fs::path file = scratch / "texture.png";
    RenderSettings settings = small_picture();
    settings.camera[0] = {};
    settings.camera[0].azimuth = 0;
    settings.camera[0].elevation = 0;
    const Box action = {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.1}};
    for (const std::array<int, 3> srgb :
         {std::array{200, 60, 20}, {40, 90, 180}, {128, 128, 128}}) {
        Image texture{16, 16, {}};
        Vec3 linear;
        for (int i = 0; i < 3; ++i) {
            linear[i] = linear_from_srgb(srgb[static_cast<std::size_t>(i)] / 255.0);
        }
        for (int i = 0; i < 256; ++i) {
            for (const int c : srgb) texture.rgb.push_back(static_cast<std::uint8_t>(c));
        }
        write_png(file, texture);
        const TriMesh mesh = square(1);
        SurfaceMaterial textured = colored({1, 1, 1});
        textured.texture = file;
        const Image a = drawn(settings, {{&mesh, nullptr, {}, textured}}, -0.5, action);
        const Image b = drawn(settings, {{&mesh, nullptr, {}, colored(linear)}}, -0.5, action);
        // Also where it came inside the mesh.
        SurfaceMaterial inside = colored({1, 1, 1});
        inside.embedded_texture = std::make_shared<const std::string>(encode_png(texture));
        CHECK((drawn(settings, {{&mesh, nullptr, {}, inside}}, -0.5, action).rgb == a.rgb));
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(std::abs(a.pixel(80, 60)[c] - b.pixel(80, 60)[c]) <= 1);
        }
        // Brighter in the texture is brighter in the picture, in the same order.
        const std::uint8_t* p = a.pixel(80, 60);
        CHECK((p[0] > p[2]) == (srgb[0] > srgb[2]));
    }
}

TEST_CASE("a texture stands upright", "[renderer]") {
    if (!can_draw()) return;
    const Scratch scratch;
    const fs::path file = scratch / "texture.png";
    Image texture{64, 64, {}};  // red over blue
    for (int i = 0; i < 64 * 64; ++i) {
        for (const int c : {i < 2048 ? 200 : 0, 0, i < 2048 ? 0 : 200}) {
            texture.rgb.push_back(static_cast<std::uint8_t>(c));
        }
    }
    write_png(file, texture);
    RenderSettings settings = small_picture();
    settings.camera[0].azimuth = settings.camera[0].elevation = 0;
    const TriMesh mesh = square(1);
    SurfaceMaterial textured = colored({1, 1, 1});
    textured.texture = file;
    const Image image = drawn(settings, {{&mesh, nullptr, {}, textured}}, -0.5,
                              {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.1}});
    CHECK(image.pixel(80, 40)[0] > image.pixel(80, 40)[2] + 50);
    CHECK(image.pixel(80, 80)[2] > image.pixel(80, 80)[0] + 50);
}

TEST_CASE("a texture repeats beyond 0 to 1, along both its sides", "[renderer]") {
    if (!can_draw()) return;
    const bool across = GENERATE(true, false);
    Image texture{64, 64, {}};  // half red, half blue
    for (int i = 0; i < 64 * 64; ++i) {
        const bool red = (across ? i % 64 : i / 64) < 32;
        for (const int c : {red ? 200 : 0, 0, red ? 0 : 200}) {
            texture.rgb.push_back(static_cast<std::uint8_t>(c));
        }
    }
    RenderSettings settings = small_picture();
    settings.camera[0].azimuth = settings.camera[0].elevation = 0;
    TriMesh mesh = square(1);
    for (Vec2& uv : mesh.uv) uv *= 3;
    SurfaceMaterial textured = colored({1, 1, 1});
    textured.embedded_texture = std::make_shared<const std::string>(encode_png(texture));
    const Image image = drawn(settings, {{&mesh, nullptr, {}, textured}}, -0.5,
                              {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.1}});
    int bands = 0, last = 0;
    for (int n = 0; n < (across ? image.width : image.height); ++n) {
        const std::uint8_t* p = across ? image.pixel(n, 60) : image.pixel(80, n);
        if (std::abs(p[0] - p[2]) < 60) continue;
        const int now = p[0] > p[2] ? 1 : -1;
        bands += now != last;
        last = now;
    }
    CHECK(bands == 6);
}

TEST_CASE("a missing texture leaves the plain colour", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh mesh = square(1);
    SurfaceMaterial broken = colored({0.8, 0.3, 0.1});
    broken.texture = "/no/such/picture.png";
    SurfaceMaterial inside = colored({0.8, 0.3, 0.1});
    inside.embedded_texture = std::make_shared<const std::string>("no picture");
    const Image a = drawn(small_picture(), {{&mesh, nullptr, {}, broken}});
    const Image b = drawn(small_picture(), {{&mesh, nullptr, {}, colored({0.8, 0.3, 0.1})}});
    CHECK((a.rgb == b.rgb));
    CHECK((drawn(small_picture(), {{&mesh, nullptr, {}, inside}}).rgb == b.rgb));
}

TEST_CASE("faces without texture coordinates at some corner have the plain colour", "[renderer]") {
    if (!can_draw()) return;
    RenderSettings settings = small_picture();
    settings.camera[0].azimuth = settings.camera[0].elevation = 0;
    const Box action = {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.1}};
    TriMesh mesh = square(1);
    Image texture{16, 16, {}};
    for (int i = 0; i < 256; ++i) texture.rgb.insert(texture.rgb.end(), {220, 20, 20});
    SurfaceMaterial textured = colored({0.1, 0.6, 0.1});
    textured.embedded_texture = std::make_shared<const std::string>(encode_png(texture));
    mesh.material = {textured};
    const Image whole = drawn(settings, {{&mesh, nullptr, {}, std::nullopt}}, -0.5, action);
    // Left and above the diagonal: none, or not at every corner.
    mesh.triangle_uv[1] = GENERATE(Corners{-1, -1, -1}, Corners{0, 2, -1});
    const Image half = drawn(settings, {{&mesh, nullptr, {}, std::nullopt}}, -0.5, action);
    const TriMesh bare = square(1);
    const Image plain =
        drawn(settings, {{&bare, nullptr, {}, colored({0.1, 0.6, 0.1})}}, -0.5, action);
    for (int c = 0; c < 3; ++c) {
        CHECK(std::abs(half.pixel(60, 40)[c] - plain.pixel(60, 40)[c]) <= 1);
        CHECK(std::abs(half.pixel(100, 80)[c] - whole.pixel(100, 80)[c]) <= 1);
    }
}

TEST_CASE("both sides of a surface are lit", "[renderer]") {
    if (!can_draw()) return;
    TriMesh front = square(1), back = front;
    for (Corners& t : back.triangle) std::swap(t[0], t[1]);
    back.uv.clear();
    back.triangle_uv.clear();
    RenderSettings settings = small_picture();
    settings.ground = false;
    settings.camera[0].azimuth = settings.camera[0].elevation = 0;
    const Box action = {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.1}};
    const SurfaceMaterial white = colored({0.9, 0.9, 0.9});
    const Image a = drawn(settings, {{&front, nullptr, {}, white}}, -1, action);
    const Image b = drawn(settings, {{&back, nullptr, {}, white}}, -1, action);
    CHECK(brightness(a, 80, 60) > 150);
    CHECK(mean_difference(a, b) < 1);
}

TEST_CASE("a body inside out beside a larger one is not drawn hollow", "[renderer]") {
    if (!can_draw()) return;
    const auto boxes = [](bool inside_out) {
        TriMesh mesh = box_mesh(0.8);
        const TriMesh beside = box_mesh(0.4);
        const int base = static_cast<int>(mesh.position.size());
        for (const Vec3& p : beside.position) mesh.position.push_back(p + Vec3(0.9, 0, 0.3));
        for (Corners t : beside.triangle) {
            if (inside_out) std::swap(t[0], t[1]);
            mesh.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
        }
        mesh.triangle_smooth.clear();
        mesh.smooth_group_count = 0;
        return mesh;
    };
    const auto picture = [&](bool inside_out) {
        const TriMesh mesh = boxes(inside_out);
        return drawn(small_picture(), {{&mesh, nullptr, {Quat::Identity(), {-0.3, 0.4, 0}}, {}}});
    };
    CHECK(mean_difference(picture(false), picture(true)) < 0.1);
}

TEST_CASE("colours of positions are shown", "[renderer]") {
    if (!can_draw()) return;
    TriMesh mesh = square(1);
    mesh.position_color.assign(4, Eigen::Vector3f(0.1f, 0.6f, 0.2f));
    const Image a = drawn(small_picture(), {{&mesh, nullptr, {}, colored({1, 1, 1})}});
    mesh.position_color.clear();
    const Image b = drawn(small_picture(), {{&mesh, nullptr, {}, colored({0.1f, 0.6f, 0.2f})}});
    CHECK(mean_difference(a, b) < 0.05);
    // A cut face has its rim's colours and does not show them.
    SurfaceMaterial cut = colored({0.1f, 0.6f, 0.2f});
    cut.takes_colors = false;
    mesh.position_color.assign(4, Eigen::Vector3f(1, 0, 0));
    CHECK(mean_difference(b, drawn(small_picture(), {{&mesh, nullptr, {}, cut}})) < 0.05);
}

TEST_CASE("other colours of the same positions are shown in the next picture", "[renderer]") {
    if (!can_draw()) return;
    Renderer renderer(small_picture(), kAction, 0);
    TriMesh mesh = square(1);
    const auto picture = [&](const Eigen::Vector3f& color) {
        mesh.position_color.assign(4, color);
        return renderer.draw({{{&mesh, nullptr, {}, colored({1, 1, 1})}}, 0});
    };
    const Image red = picture({0.8f, 0.1f, 0.1f}), green = picture({0.1f, 0.6f, 0.2f});
    CHECK(mean_difference(red, green) > 1);
    CHECK(mean_difference(red, picture({0.8f, 0.1f, 0.1f})) == 0);
}

TEST_CASE("given positions are drawn instead of the mesh's own, picture after picture",
          "[renderer]") {
    if (!can_draw()) return;
    const TriMesh mesh = box_mesh(0.5);
    Renderer renderer(small_picture(), kAction, 0);
    const auto picture_at = [&](double x) {
        const Pose pose{Quat::Identity(), {x, 0.3, 0}};
        return renderer.draw({{{&mesh, nullptr, pose, {}}}, 0});
    };
    std::vector<Vec3> left = mesh.position, right = mesh.position;
    for (Vec3& p : left) p += Vec3(-0.5, 0.3, 0);
    for (Vec3& p : right) p += Vec3(0.5, 0.3, 0);
    const Image a = renderer.draw({{{&mesh, &left, {}, {}}}, 0});
    CHECK(mean_difference(a, picture_at(-0.5)) < 0.2);
    const Image b = renderer.draw({{{&mesh, &right, {}, {}}}, 0});
    CHECK(mean_difference(b, picture_at(0.5)) < 0.2);
    CHECK(mean_difference(a, b) > 1);
    // One mesh twice in one picture, at different positions.
    const Image both = renderer.draw({{{&mesh, &left, {}, {}}, {&mesh, &right, {}, {}}}, 0});
    CHECK(mean_difference(both, a) > 1);
    CHECK(mean_difference(both, b) > 1);
    std::vector<Vec3> too_few(3, Vec3::Zero());
    CHECK_THROWS_AS(renderer.draw({{{&mesh, &too_few, {}, {}}}, 0}), Error);
}

TEST_CASE("size and place in the world do not change the picture", "[renderer]") {
    if (!can_draw()) return;
    const auto picture = [](double scale, const Vec3& at) {
        TriMesh mesh = box_mesh(0.8 * scale);
        for (Vec3& p : mesh.position) p += at + Vec3(0, 0.45 * scale, 0);
        const Box action = {at + scale * kAction.low, at + scale * kAction.high};
        return drawn(small_picture(), {{&mesh, nullptr, {}, {}}}, at.y(), action);
    };
    const Image a = picture(1, Vec3::Zero());
    CHECK(mean_difference(a, picture(1e-4, Vec3::Zero())) < 0.2);
    CHECK(mean_difference(a, picture(1e4, Vec3::Zero())) < 0.2);
    CHECK(mean_difference(a, picture(1, {1e5, -1e5, 3e4})) < 0.2);
    // Also where a mesh from near the origin has gone there.
    const Vec3 at(1e6, -1e6, 3e5);
    const TriMesh mesh = box_mesh(0.8);
    std::vector<Vec3> there;
    for (const Vec3& p : mesh.position) there.push_back(p + at + Vec3(0, 0.45, 0));
    const Box action = {at + kAction.low, at + kAction.high};
    CHECK(mean_difference(a, drawn(small_picture(), {{&mesh, &there, {}, {}}}, at.y(), action)) <
          0.2);
}

TEST_CASE("the camera's keys move the picture", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh mesh = box_mesh(0.6);
    RenderSettings settings = small_picture();
    settings.camera = {{0, 0.0, 0.4, 1, {}, {}}, {1, 0.7, 0.4, 1, {}, {}}};
    Renderer renderer(settings, kAction, 0);
    const std::vector<DrawItem> items = {{&mesh, nullptr, {Quat::Identity(), {0, 0.3, 0}}, {}}};
    const Image a = renderer.draw({items, 0}), b = renderer.draw({items, 1});
    CHECK(mean_difference(a, b) > 0.5);
    CHECK((renderer.draw({items, 0}).rgb == a.rgb));
}

TEST_CASE("many triangles are smoothed afterwards and look the same from afar", "[renderer]") {
    if (!can_draw()) return;
    const auto sheet = [](int n) {
        TriMesh mesh;
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n; ++j) mesh.position.push_back({1.0 * i / n, 0.3, 1.0 * j / n});
        }
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const int a = i * (n + 1) + j, b = a + n + 1;
                mesh.triangle.push_back({a, a + 1, b});
                mesh.triangle.push_back({b, a + 1, b + 1});
            }
        }
        return mesh;
    };
    const TriMesh few = sheet(4), many = sheet(400);
    const Image a = drawn(small_picture(), {{&few, nullptr, {}, {}}});
    const Image b = drawn(small_picture(), {{&many, nullptr, {}, {}}});
    CHECK(mean_difference(a, b) < 1);
}

TEST_CASE("corners that differ become vertices of their own, others are shared", "[renderer]") {
    TriMesh mesh = square(1);
    smooth_by_crease_angle(mesh, 1);
    CHECK(split_corners(mesh).vertex_position.size() == 4);
    mesh.triangle_uv[1] = {-1, -1, -1};  // a seam along the diagonal
    const DrawMesh split = split_corners(mesh);
    CHECK(split.vertex_position.size() == 6);
    CHECK(split.index.size() == 6);
    REQUIRE(split.range.size() == 2);
    for (const DrawMesh::Range& range : split.range) {
        const std::size_t t = range.textured ? 0 : 1;
        REQUIRE(range.count == 3);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto v = split.index[range.first + c];
            CHECK(split.vertex_position[v] == mesh.triangle[t][c]);
            CHECK(split.vertex_uv[v] == mesh.triangle_uv[t][c]);
        }
    }
    mesh.triangle_material = {1, 0};
    const DrawMesh sorted = split_corners(mesh);
    REQUIRE(sorted.range.size() == 2);
    CHECK(sorted.range[0].material == 0);
    CHECK(sorted.index[0] == 0);
    CHECK(sorted.vertex_position[sorted.index[1]] == mesh.triangle[1][1]);
}
