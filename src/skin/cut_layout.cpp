// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_layout.h"

#include <algorithm>

#include "skin/new_look.h"

namespace swage {

namespace {

// An axis later than another has to be this much more across: cuts at 45 degrees are of one.
constexpr double kMore = 1.05;

int axis_across(const Vec3& normal) {
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(normal[k]) > kMore * std::abs(normal[axis])) axis = k;
    }
    return axis;
}

}  // namespace

void lay_out_cuts(TriMesh& skin) {
    const auto is_cut = [&](std::size_t t) {
        if (skin.triangle_material.empty()) return false;
        return is_cut_look(skin.material[skin.triangle_material[t]]);
    };
    std::vector<int> made;  // of each place, seen along each axis
    for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
        if (!is_cut(t)) continue;
        if (skin.triangle_uv.empty()) skin.triangle_uv.assign(skin.triangle.size(), {-1, -1, -1});
        if (made.empty()) made.assign(3 * skin.position.size(), -1);
        Corners& uv = skin.triangle_uv[t];
        if (*std::max_element(uv.begin(), uv.end()) >= 0) continue;
        const int axis = axis_across(area_vector(skin.position, skin.triangle[t]));
        for (int k = 0; k < 3; ++k) {
            const int v = skin.triangle[t][k];
            int& number = made[3 * static_cast<std::size_t>(v) + axis];
            if (number < 0) {
                number = static_cast<int>(skin.uv.size());
                const Vec3& place = skin.position[v];
                skin.uv.emplace_back(place[(axis + 1) % 3], place[(axis + 2) % 3]);
            }
            uv[k] = number;
        }
    }
}

}  // namespace swage
