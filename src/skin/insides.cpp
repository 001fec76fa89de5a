// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/insides.h"

#include <utility>

namespace swage {

void Insides::add(TriMesh surface, SurfaceMaterial look) {
    if (surface.triangle.empty()) return;
    tree_.emplace_back(surface);
    surface_.push_back(std::move(surface));
    look_.push_back(std::move(look));
}

std::vector<std::array<Vec2, 2>> Insides::lines_in(const BladePath& path) const {
    std::vector<std::array<Vec2, 2>> lines;
    for (const TriMesh& surface : surface_) {
        std::vector<double> height;
        for (const Vec3& p : surface.position) height.push_back(path.height(p));
        // From the lower number, so that two triangles have the same to the bit.
        const auto crossing = [&](int a, int b) -> Vec2 {
            if (a > b) std::swap(a, b);
            const double share = height[a] / (height[a] - height[b]);
            const Vec3 &low = surface.position[a], &high = surface.position[b];
            return path.flat(low + share * (high - low));
        };
        for (const Corners& t : surface.triangle) {
            std::array<Vec2, 2> line;
            int ends = 0;
            for (int k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3];
                if ((height[a] >= 0) != (height[b] >= 0)) line[ends++] = crossing(a, b);
            }
            if (ends == 2) lines.push_back(line);
        }
    }
    return lines;
}

int Insides::at(const Vec3& point) const {
    for (int n = static_cast<int>(tree_.size()) - 1; n >= 0; --n) {
        if (tree_[n].winding_number(point) > 0.5) return n;
    }
    return -1;
}

}  // namespace swage
