// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: G. T. Klincsek, "Minimal triangulations of polygonal domains", 1980.
#include "skin/thick_triangles.h"

#include <algorithm>
#include <array>
#include <limits>

namespace swage {

double thickness(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0.0;
}

std::vector<Corners> thick_triangles(int count,
                                     const std::function<double(int, int, int)>& thickness) {
    // Of the corners from one to another, and the one between that both are joined with.
    struct Best {
        double thickness = std::numeric_limits<double>::infinity();
        int middle = -1;
    };
    std::vector<Best> best(static_cast<std::size_t>(count) * count);
    const auto between = [&](int a, int b) -> Best& {
        return best[static_cast<std::size_t>(a) * count + b];
    };
    for (int far = 2; far < count; ++far) {
        for (int a = 0; a + far < count; ++a) {
            Best& own = between(a, a + far);
            for (int m = a + 1; m < a + far; ++m) {
                const double least =
                    std::min({between(a, m).thickness, between(m, a + far).thickness,
                              thickness(a, m, a + far)});
                if (own.middle < 0 || least > own.thickness) own = {least, m};
            }
        }
    }
    std::vector<Corners> triangles;
    std::vector<std::array<int, 2>> open = {{0, count - 1}};
    while (!open.empty()) {
        const auto [a, b] = open.back();
        open.pop_back();
        if (b - a < 2) continue;
        const int m = between(a, b).middle;
        triangles.push_back({a, m, b});
        open.push_back({m, b});
        open.push_back({a, m});
    }
    return triangles;
}

}  // namespace swage
