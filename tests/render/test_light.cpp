// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow and occlusion, as the pictures show them.
#include "render/camera.h"
#include "tests/render/drawn.h"

using namespace swage;

TEST_CASE("a body throws a shadow on the ground", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh box = box_mesh(0.4);
    RenderSettings settings = small_picture();
    settings.camera[0].elevation = 1.2;
    const Image without = drawn(settings, {});
    const Image with =
        drawn(settings, {{&box, nullptr, {Quat::Identity(), {0, 0.2, 0}}, colored({1, 1, 1})}});
    int darker = 0, brighter_ground = 0;
    for (int y = 0; y < with.height; ++y) {
        for (int x = 0; x < with.width; ++x) {
            const double change = brightness(with, x, y) - brightness(without, x, y);
            if (change < -25) ++darker;
            if (change > 1 && (x < 30 || x > 130)) ++brighter_ground;
        }
    }
    CHECK(darker > 100);
    CHECK(brighter_ground == 0);  // and nothing else changes the ground
}

TEST_CASE("a shadow has no teeth along the edge of what throws it", "[renderer]") {
    if (!can_draw()) return;
    // A red board, aslant in the picture, a little above the ground.
    const TriMesh board = surface_of(BoxShape{Vec3(2, 0.1, 0.4), 0});
    RenderSettings settings = small_picture();
    settings.width = 640, settings.height = 480;
    settings.camera[0].azimuth = GENERATE(0.2, 0.4, 0.7);
    settings.camera[0].elevation = 0.3;
    const Image image =
        drawn(settings, {{&board, nullptr, {Quat::Identity(), {0, 0.06, 0}}, colored({1, 0, 0})}});
    const auto is_ground = [&](int x, int y) {
        const std::uint8_t* p = image.pixel(x, y);
        return p[0] < p[2] + 20;
    };
    // The front edge, a straight line through where the ground begins in each column.
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int x = 200; x < 440; ++x) {
        int y = image.height - 1;
        while (y > 0 && is_ground(x, y)) --y;
        n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), start = (sy - slope * sx) / n;
    const auto below_edge = [&](int x) {
        const double y = start + slope * x + 4;
        const int row = static_cast<int>(y);
        REQUIRE(is_ground(x, row));
        return brightness(image, x, row) * (row + 1 - y) +
               brightness(image, x, row + 1) * (y - row);
    };
    // What neighbours along the edge do not share.
    double rough = 0;
    for (int x = 203; x < 437; ++x) {
        rough += std::abs(below_edge(x) - 0.5 * (below_edge(x - 3) + below_edge(x + 3))) / 234;
    }
    INFO("rough by " << rough << " of 255");
    CHECK(rough < 0.9);
}

TEST_CASE("a face in shadow casts no teeth over a hard edge on a lit one", "[renderer]") {
    if (!can_draw()) return;
    // The side's shade begins a column beside the lit front; the edge runs aslant through pixels.
    const TriMesh cube = surface_of(BoxShape{Vec3(1, 1, 1), 0});
    RenderSettings settings = small_picture();
    settings.width = 640, settings.height = 480;
    settings.camera[0].azimuth = GENERATE(0.3, 0.45, 0.6);
    settings.camera[0].elevation = 0.5;
    const Image image = drawn(
        settings, {{&cube, nullptr, {Quat::Identity(), {-0.3, 0.5, 0}}, colored({0.8, 0.8, 0.8})}});
    double most = 0;
    int rows = 0;
    for (int y = 210; y < 310; ++y) {
        const auto drop = [&](int x) {
            return brightness(image, x, y) - brightness(image, x + 2, y);
        };
        int edge = 150;
        for (int x = 150; x < 490; ++x) {
            if (drop(x) > drop(edge)) edge = x;
        }
        if (drop(edge) < 20) continue;
        ++rows;
        for (int off = 2; off < 6; ++off) {
            most =
                std::max(most, brightness(image, edge - 12, y) - brightness(image, edge - off, y));
        }
    }
    INFO("darker by up to " << most << " of 255 in " << rows << " rows");
    CHECK(rows > 60);
    CHECK(most < 3);
}

TEST_CASE("a large picture is shaded as a small one", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh board = surface_of(BoxShape{Vec3(1, 0.05, 1), 0});
    const auto picture = [&](int scale) {
        RenderSettings settings = small_picture();
        settings.width = 200 * scale, settings.height = 150 * scale;
        settings.camera[0].zoom = 2;
        const SurfaceMaterial white = colored({0.8, 0.8, 0.8});
        const Quat on_edge(Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX()));
        return drawn(settings, {{&board, nullptr, {Quat::Identity(), {0, 0.3, 0}}, white},
                                {&board, nullptr, {on_edge, {0, 0.5, -0.3}}, white}});
    };
    const int scale = 12;
    const Image small = picture(1), large = picture(scale);
    double apart = 0;
    for (int y = 2; y < small.height - 2; ++y) {
        for (int x = 2; x < small.width - 2; ++x) {
            double sum = 0;
            for (int i = 0; i < scale * scale; ++i) {
                sum += brightness(large, scale * x + i % scale, scale * y + i / scale);
            }
            apart += std::abs(sum / (scale * scale) - brightness(small, x, y));
        }
    }
    apart /= (small.width - 4.0) * (small.height - 4.0);
    INFO("apart by " << apart << " of 255");
    CHECK(apart < 1);
}

TEST_CASE("a soft edge of a shadow shows no single samples in a near view", "[renderer]") {
    if (!can_draw()) return;
    const TriMesh board = surface_of(BoxShape{Vec3(0.5, 0.05, 0.5), 0});
    RenderSettings settings = small_picture();
    settings.width = 960, settings.height = 540;
    settings.camera[0].elevation = 1.4;
    settings.camera[0].zoom = 5;
    // Where the light through the board's middle meets the ground, and a little beside it.
    const double azimuth = settings.camera[0].azimuth - 0.8 + kPi, far = 0.8 / std::tan(0.9);
    settings.camera[0].target = Vec3(far * std::sin(azimuth) + 0.2, 0, far * std::cos(azimuth));
    const Image image = drawn(settings, {{&board, nullptr, {Quat::Identity(), {0, 0.8, 0}}, {}}});
    const int side = 6, columns = image.width / side, rows = image.height / side;
    const auto block = [&](int column, int row) {  // a mean, which takes out the dither
        double sum = 0;
        for (int i = 0; i < side * side; ++i) {
            sum += brightness(image, column * side + i % side, row * side + i / side);
        }
        return sum / (side * side);
    };
    double rough = 0, low = 255, high = 0;
    for (int row = 1; row + 1 < rows; ++row) {
        for (int column = 1; column + 1 < columns; ++column) {
            const double here = block(column, row);
            low = std::min(low, here);
            high = std::max(high, here);
            rough += std::abs(here - 0.5 * (block(column - 1, row) + block(column + 1, row))) +
                     std::abs(here - 0.5 * (block(column, row - 1) + block(column, row + 1)));
        }
    }
    rough /= 2.0 * (rows - 2) * (columns - 2);
    INFO("rough by " << rough << " of " << high - low);
    CHECK(high - low > 40);  // an edge, indeed
    CHECK(rough < 0.1);
}

TEST_CASE("a crease is as dark through any lens and from any distance, and never black",
          "[renderer]") {
    if (!can_draw()) return;
    const TriMesh board = surface_of(BoxShape{Vec3(2, 0.2, 1), 0});
    const SurfaceMaterial white = colored({0.8, 0.8, 0.8});
    const Quat on_edge(Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX()));
    // Seen from below, where the key light does not reach.
    const std::vector<DrawItem> corner = {
        {&board, nullptr, {Quat::Identity(), {0, 0.7, 0.4}}, white},  // its underside at 0.6
        {&board, nullptr, {on_edge, {0, 0.5, -0.2}}, white}};         // its front at -0.1
    // Brightness of the underside at some distances from the crease.
    const auto seen = [&](double zoom, double lens, int width, int height) {
        RenderSettings settings = small_picture();
        settings.ground = false;
        settings.width = width, settings.height = height;
        settings.field_of_view = lens;
        settings.camera[0].azimuth = 0;
        settings.camera[0].elevation = -0.6;
        settings.camera[0].zoom = zoom;
        const Image image = drawn(settings, corner);
        const View view = CameraPath(settings, kAction).at(0);
        std::vector<double> light;
        for (const double off : {0.015, 0.03, 0.06, 0.12, 0.25}) {
            const Vec3 p = view.in_view({0, 0.6, -0.1 + off});
            const double high = 0.5 * height * (1 + p.y() / p.z() / std::tan(0.5 * lens));
            light.push_back(brightness(image, width / 2, static_cast<int>(high)));
        }
        return light;
    };
    const std::vector<double> usual = seen(1, 0.6, 1280, 720);
    CHECK(usual.front() < usual.back() - 25);  // a crease, indeed
    const auto same = [&](const std::vector<double>& light) {
        for (std::size_t i = 0; i < light.size(); ++i) {
            INFO("place " << i << ": " << light[i] << " where it was " << usual[i]);
            CHECK(std::abs(light[i] - usual[i]) < 8);
        }
    };
    for (const double zoom : {0.8, 1.6, 2.2, 3.5}) {
        INFO("zoom " << zoom);
        same(seen(zoom, 0.6, 960, 540));
    }
    for (const double lens : {0.2, 1.05}) {
        INFO("lens " << lens);
        same(seen(2.2, lens, 960, 540));
    }
    same(seen(1, 0.6, 2560, 1440));
}
