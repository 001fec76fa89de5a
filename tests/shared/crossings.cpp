// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/crossings.h"

#include <algorithm>
#include <numeric>

#include "geometry/box.h"

namespace swage::test {

namespace {

using Places = std::array<Vec3, 3>;

// Whether an edge goes through the inside of a triangle.
bool pierces(const Vec3& p, const Vec3& q, const Places& t) {
    const Vec3 area = (t[1] - t[0]).cross(t[2] - t[0]);
    const double size = area.norm();
    if (!(size > 0)) return false;
    const double over = area.dot(p - t[0]) / size, under = area.dot(q - t[0]) / size;
    const double touch = 1e-9 * (q - p).norm();
    if (!(std::min(over, under) < -touch && std::max(over, under) > touch)) return false;
    const Vec3 at = p + over / (over - under) * (q - p);
    for (int k = 0; k < 3; ++k) {
        if ((t[(k + 1) % 3] - t[k]).cross(at - t[k]).dot(area) < 1e-7 * size * size) return false;
    }
    return true;
}

bool cross(const Places& s, const Places& t) {
    std::array<bool, 3> in_t{}, in_s{};
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (s[i] == t[j]) in_t[i] = in_s[j] = true, ++shared;
        }
    }
    if (shared > 1) return false;
    for (int k = 0; k < 3; ++k) {
        const int m = (k + 1) % 3;
        if (!in_t[k] && !in_t[m] && pierces(s[k], s[m], t)) return true;
        if (!in_s[k] && !in_s[m] && pierces(t[k], t[m], s)) return true;
    }
    return false;
}

}  // namespace

int crossings(const TriMesh& mesh) {
    std::vector<Places> place;
    std::vector<Box> box;
    for (const auto& [a, b, c] : mesh.triangle) {
        place.push_back({mesh.position[a], mesh.position[b], mesh.position[c]});
        box.emplace_back();
        for (const Vec3& p : place.back()) box.back().grow(p);
    }
    std::vector<int> order(place.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int p, int q) { return box[p].low.x() < box[q].low.x(); });
    int count = 0;
    for (std::size_t n = 0; n < order.size(); ++n) {
        const int s = order[n];
        for (std::size_t m = n + 1; m < order.size(); ++m) {
            const int t = order[m];
            if (box[t].low.x() > box[s].high.x()) break;
            if (box[s].overlaps(box[t]) && cross(place[s], place[t])) ++count;
        }
    }
    return count;
}

}  // namespace swage::test
