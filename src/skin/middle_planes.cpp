// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/middle_planes.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

// In spacings. Of vertices this far away all that is cut off is as good as what the mesh has; where
// they lie too near to each other for that, the widest gap is taken.
constexpr double kClear = 0.01;
constexpr int kSteps = 13;  // to each side of the middle
// One way a little more than the other, so that no two are as far off.
constexpr double kStep = 0.0037, kOtherStep = 0.0038;
constexpr double kReach = kSteps * kOtherStep + kClear;

struct Near {
    std::vector<double> vertex;  // spacings from the middle
    struct Face {
        double off, area;  // upwards, in squares of the spacing
    };
    std::vector<Face> face;
};

double clearance(const std::vector<double>& vertex, double off) {
    const auto next = std::lower_bound(vertex.begin(), vertex.end(), off);
    double clear = kClear;
    if (next != vertex.end()) clear = std::min(clear, *next - off);
    if (next != vertex.begin()) clear = std::min(clear, off - *std::prev(next));
    return clear;
}

// What a plane there shaves off a body behind faces along it, and how far it is off.
double cost(const std::vector<Near::Face>& face, double off) {
    double shaved = 0;
    for (const auto& [at, area] : face) {
        if ((area > 0) == (off < at)) shaved += std::abs(area);
    }
    return shaved + std::abs(off);
}

double best_place(Near& near) {
    std::vector<double>& vertex = near.vertex;
    std::sort(vertex.begin(), vertex.end());
    double best = 0, most = -1, least = 0;
    for (int step = -kSteps; step <= kSteps; ++step) {
        const double off = step * (step < 0 ? kStep : kOtherStep);
        if (clearance(vertex, off) < kClear) continue;
        const double own = cost(near.face, off);
        if (most < 0 || own < least) best = off, least = own, most = kClear;
    }
    for (std::size_t n = 0; most < kClear && n + 1 < vertex.size(); ++n) {
        const double clear = 0.5 * (vertex[n + 1] - vertex[n]);
        if (clear > most) best = vertex[n] + clear, most = clear;
    }
    return best;
}

}  // namespace

double MiddlePlanes::at(int axis, int number) const {
    const Row& row = row_[axis];
    const int n = number - row.first;
    const bool chosen = n >= 0 && n < static_cast<int>(row.off.size());
    return origin_[axis] + spacing_ * (number + 0.5 + (chosen ? row.off[n] : 0.0));
}

void MiddlePlanes::choose(int axis, const std::vector<Vec3>& position,
                          const std::vector<Corners>& triangle) {
    Row& row = row_[axis];
    row = {};
    if (position.empty()) return;
    const auto height = [&](int v) { return (position[v][axis] - origin_[axis]) / spacing_ - 0.5; };
    const auto nearest = [&](int v) { return static_cast<int>(std::lround(height(v))); };
    int low = nearest(0), high = low;
    for (std::size_t v = 0; v < position.size(); ++v) {
        low = std::min(low, nearest(static_cast<int>(v)));
        high = std::max(high, nearest(static_cast<int>(v)));
    }
    row.first = low;
    std::vector<Near> near(static_cast<std::size_t>(high - low + 1));
    const auto off = [&](int v) { return height(v) - nearest(v); };
    for (std::size_t n = 0; n < position.size(); ++n) {
        const int v = static_cast<int>(n);
        if (std::abs(off(v)) < kReach) near[nearest(v) - low].vertex.push_back(off(v));
    }
    for (const auto& [a, b, c] : triangle) {
        const int number = nearest(a);
        if (nearest(b) != number || nearest(c) != number) continue;
        const double most = std::max({std::abs(off(a)), std::abs(off(b)), std::abs(off(c))});
        if (most >= kReach) continue;
        const Vec3 area = (position[b] - position[a]).cross(position[c] - position[a]);
        near[number - low].face.push_back(
            {(off(a) + off(b) + off(c)) / 3, 0.5 * area[axis] / (spacing_ * spacing_)});
    }
    for (Near& one : near) row.off.push_back(best_place(one));
}

}  // namespace swage
