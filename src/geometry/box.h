// SPDX-License-Identifier: GPL-3.0-or-later
// Axis-aligned boxes.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "base/math.h"

namespace swage {

struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    bool empty() const {
        return !(low.x() <= high.x() && low.y() <= high.y() && low.z() <= high.z());
    }
    Vec3 size() const { return high - low; }
    Vec3 center() const { return 0.5 * (low + high); }
    // Bit 0 along x, bit 1 along y, bit 2 along z.
    Vec3 corner(int c) const {
        return {(c & 1 ? high : low).x(), (c & 2 ? high : low).y(), (c & 4 ? high : low).z()};
    }
    void grow(const Vec3& point) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], point[i]);
            high[i] = std::max(high[i], point[i]);
        }
    }
    void grow(const Box& other) {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
    Box widened(double by) const { return {low - Vec3::Constant(by), high + Vec3::Constant(by)}; }
    // With their faces.
    bool contains(const Vec3& point) const {
        return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
    }
    // 0: it is inside.
    double gap_to(const Vec3& point) const {
        return (low - point).cwiseMax(point - high).cwiseMax(0.0).norm();
    }
    bool overlaps(const Box& other) const {
        return (low.array() <= other.high.array()).all() &&
               (other.low.array() <= high.array()).all();
    }
};

// 0: they overlap.
inline double gap_between(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

inline Box box_of(const std::vector<Vec3>& points) {
    Box box;
    for (const Vec3& p : points) box.grow(p);
    return box;
}

}  // namespace swage
