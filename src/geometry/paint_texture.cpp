// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geometry/atlas.h"

namespace swage {

namespace {

struct Texel {
    int triangle = -1;
    std::array<float, 3> share{};  // of its corners; outside it some are negative
    float outside = 1e9f;          // how far out of it, in shares; <= 0 within
};

// Finds for each texel the triangle that covers it or, within two texels, comes nearest to it.
std::vector<Texel> rasterise(const TriMesh& mesh, int size) {
    constexpr double kReach = 2;
    std::vector<Texel> texel(static_cast<std::size_t>(size) * size);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        std::array<Vec2, 3> p;
        for (int k = 0; k < 3; ++k) {
            const Vec2& uv = mesh.uv[mesh.triangle_uv[t][k]];
            p[k] = size * Vec2(uv.x(), 1 - uv.y());
        }
        const auto turn = [](const Vec2& a, const Vec2& b) {
            return a.x() * b.y() - a.y() * b.x();
        };
        const double area = turn(p[1] - p[0], p[2] - p[0]);
        if (area == 0) continue;
        const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]) - Vec2::Constant(kReach);
        const Vec2 high = p[0].cwiseMax(p[1]).cwiseMax(p[2]) + Vec2::Constant(kReach);
        for (int y = std::max(0, static_cast<int>(low.y())); y < std::min<double>(size, high.y());
             ++y)
            for (int x = std::max(0, static_cast<int>(low.x()));
                 x < std::min<double>(size, high.x()); ++x) {
                const Vec2 at(x + 0.5, y + 0.5);
                std::array<float, 3> share;
                for (int k = 0; k < 3; ++k)
                    share[k] =
                        static_cast<float>(turn(p[(k + 1) % 3] - at, p[(k + 2) % 3] - at) / area);
                const float outside = -*std::min_element(share.begin(), share.end());
                Texel& best = texel[static_cast<std::size_t>(y) * size + x];
                if (outside < best.outside) best = {static_cast<int>(t), share, outside};
            }
    }
    return texel;
}

// Gives each texel that shows no place the mean colour of the neighbours that have one, ring by
// ring, so that neither filtering nor smaller copies of the texture bleed into the charts.
void fill_between(std::vector<Vec3>& color, std::vector<bool>& known, int size) {
    std::vector<int> open;
    for (int i = 0; i < size * size; ++i)
        if (!known[i]) open.push_back(i);
    while (!open.empty() && open.size() < color.size()) {
        std::vector<int> filled, left;
        for (int i : open) {
            Vec3 sum = Vec3::Zero();
            int count = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int x = i % size + dx, y = i / size + dy;
                    if (x < 0 || y < 0 || x >= size || y >= size || !known[y * size + x]) continue;
                    sum += color[y * size + x];
                    ++count;
                }
            if (count > 0) {
                color[i] = sum / count;
                filled.push_back(i);
            } else {
                left.push_back(i);
            }
        }
        for (int i : filled) known[i] = true;
        open.swap(left);
    }
}

}  // namespace

Texture paint_texture(const TriMesh& mesh, int size, const Paint& paint) {
    const std::vector<Texel> texel = rasterise(mesh, size);
    const std::vector<Vec3> normal = smooth_normals(mesh, mesh.position);
    std::vector<Vec3> color(texel.size(), Vec3::Constant(0.5));
    parallel_for(size, [&](std::size_t row) {
        for (std::size_t i = row * size; i < (row + 1) * size; ++i) {
            const int t = texel[i].triangle;
            if (t < 0) continue;
            Vec3 place = Vec3::Zero(), out = Vec3::Zero();
            for (int k = 0; k < 3; ++k) {
                place += texel[i].share[k] * mesh.position[mesh.triangle[t][k]];
                out += texel[i].share[k] * normal[mesh.triangle_smooth[t][k]];
            }
            color[i] = paint(place, out.normalized());
        }
    });
    std::vector<bool> known(texel.size());
    for (std::size_t i = 0; i < texel.size(); ++i) known[i] = texel[i].triangle >= 0;
    fill_between(color, known, size);

    Texture texture;
    texture.width = texture.height = size;
    texture.rgb.reserve(3 * texel.size());
    for (const Vec3& c : color)
        for (int k = 0; k < 3; ++k)
            texture.rgb.push_back(
                static_cast<std::uint8_t>(std::lround(255 * std::clamp(c[k], 0.0, 1.0))));
    return texture;
}

}  // namespace swage
