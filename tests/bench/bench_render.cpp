// SPDX-License-Identifier: GPL-3.0-or-later
// One still of 100,000 moving triangles at 1280 x 720 with shadow, occlusion and anti-aliasing,
// PNG written: milliseconds by phase, medians over 15 pictures. Up to 60,000 triangles edges are
// multisampled, above softened afterwards.
//     bench_render [triangles] [width] [height] [threads]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>

#include "base/stopwatch.h"
#include "render/png.h"
#include "render/renderer.h"

using namespace swage;

namespace {

// A closed tube round a trefoil knot, with bumps that travel along it as `time` goes.
std::vector<Vec3> knot(int around, int along, double time) {
    std::vector<Vec3> position;
    const auto center = [](double t) {
        return Vec3(std::sin(t) + 2 * std::sin(2 * t), -std::sin(3 * t),
                    std::cos(t) - 2 * std::cos(2 * t));
    };
    for (int i = 0; i < along; ++i) {
        const double t = 2 * kPi * i / along;
        const Vec3 ahead = (center(t + 1e-4) - center(t - 1e-4)).normalized();
        const Vec3 side = ahead.cross(Vec3(0.2, 1, 0.1)).normalized(), up = side.cross(ahead);
        for (int j = 0; j < around; ++j) {
            const double a = 2 * kPi * j / around;
            const double radius = 0.55 + 0.05 * std::sin(24 * t + 4 * time) * std::sin(6 * a);
            position.push_back(center(t) + radius * (std::cos(a) * side + std::sin(a) * up));
        }
    }
    return position;
}

TriMesh knot_mesh(int around, int along) {
    TriMesh mesh;
    mesh.position = knot(around, along, 0);
    const auto id = [&](int i, int j) { return (i % along) * around + j % around; };
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < around; ++j) {
            mesh.triangle.push_back({id(i, j), id(i, j + 1), id(i + 1, j + 1)});
            mesh.triangle.push_back({id(i, j), id(i + 1, j + 1), id(i + 1, j)});
        }
    }
    SurfaceMaterial material;
    material.color = {0.45, 0.10, 0.05};
    material.roughness = 0.4;
    mesh.material = {material};
    smooth_by_crease_angle(mesh, 1.0);
    return mesh;
}

double milliseconds(const Stopwatch::Clock::duration& duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace

int main(int count, char** word) {
    const int triangles = count > 1 ? std::atoi(word[1]) : 100'000;
    RenderSettings settings;
    if (count > 2) settings.width = std::atoi(word[2]);
    if (count > 3) settings.height = std::atoi(word[3]);
    const int threads = count > 4 ? std::atoi(word[4]) : 2;

    const int around = static_cast<int>(std::sqrt(triangles / 20.0));
    const int along = triangles / 2 / around;
    const TriMesh mesh = knot_mesh(around, along);
    const Box bounds = box_of(mesh.position);

    const auto start = Stopwatch::Clock::now();
    Renderer renderer(settings, bounds, bounds.low.y(), threads);
    const auto ready = Stopwatch::Clock::now();
    renderer.draw({{{&mesh, nullptr, {}, {}}}, 0});
    std::printf("%s\n%zu triangles, %d x %d\nset-up %.0f ms, first picture %.0f ms\n",
                renderer.renderer_string().c_str(), mesh.triangle.size(), settings.width,
                settings.height, milliseconds(ready - start),
                milliseconds(Stopwatch::Clock::now() - ready));

    const auto file = std::filesystem::temp_directory_path() / "swage_bench_render.png";
    std::vector<double> draw, encode, write, whole;
    const std::clock_t cpu_start = std::clock();
    constexpr int kPictures = 15;
    for (int i = 0; i < kPictures; ++i) {
        const std::vector<Vec3> position = knot(around, along, 0.1 * i);
        const auto a = Stopwatch::Clock::now();
        const Image image = renderer.draw({{{&mesh, &position, {}, {}}}, 0});
        const auto b = Stopwatch::Clock::now();
        const std::string bytes = encode_png(image);
        const auto c = Stopwatch::Clock::now();
        write_png(file, image);
        const auto d = Stopwatch::Clock::now();
        draw.push_back(milliseconds(b - a));
        encode.push_back(milliseconds(c - b));
        write.push_back(std::max(0.0, milliseconds(d - c) - encode.back()));
        whole.push_back(draw.back() + milliseconds(d - c));
    }
    const double cpu = 1000.0 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    std::printf("draw %.1f, encode %.1f, write %.1f ms; one still %.1f ms (bar: 180)\n",
                median(draw), median(encode), median(write), median(whole));
    std::printf("processor time a picture %.0f ms, with one more encoding and the bumps\n",
                cpu / kPictures);

    Stopwatch watch;
    renderer.time_passes(&watch);
    for (int i = 0; i < kPictures; ++i) {
        const std::vector<Vec3> position = knot(around, along, 0.1 * i);
        renderer.draw({{{&mesh, &position, {}, {}}}, 0});
    }
    for (const auto& [pass, seconds] : watch.phases()) {
        std::printf("    %-12s %6.1f ms\n", pass.c_str(), 1000 * seconds / kPictures);
    }
    return 0;
}
