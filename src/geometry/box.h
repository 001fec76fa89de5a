// SPDX-License-Identifier: GPL-3.0-or-later
// Axis-aligned boxes. Read by nearly every source: written out by coordinates, as expressions of
// Eigen take far longer to compile.
#pragma once

#include <algorithm>
#include <cmath>
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
    Vec3 size() const { return {high.x() - low.x(), high.y() - low.y(), high.z() - low.z()}; }
    Vec3 center() const {
        return {0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()), 0.5 * (low.z() + high.z())};
    }
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
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], other.low[i]);
            high[i] = std::max(high[i], other.high[i]);
        }
    }
    Box widened(double by) const {
        return {{low.x() - by, low.y() - by, low.z() - by},
                {high.x() + by, high.y() + by, high.z() + by}};
    }
    // With their faces.
    bool contains(const Vec3& point) const {
        for (int i = 0; i < 3; ++i) {
            if (!(low[i] <= point[i] && point[i] <= high[i])) return false;
        }
        return true;
    }
    // 0: it is inside.
    double gap_to(const Vec3& point) const;
    bool overlaps(const Box& other) const {
        for (int i = 0; i < 3; ++i) {
            if (!(low[i] <= other.high[i] && other.low[i] <= high[i])) return false;
        }
        return true;
    }
};

// 0: they overlap.
inline double gap_between(const Box& a, const Box& b) {
    double squares = 0;
    for (int i = 0; i < 3; ++i) {
        const double gap = std::max(std::max(a.low[i] - b.high[i], b.low[i] - a.high[i]), 0.0);
        squares += gap * gap;
    }
    return std::sqrt(squares);
}
inline double Box::gap_to(const Vec3& point) const { return gap_between(*this, {point, point}); }

inline Box box_of(const std::vector<Vec3>& points) {
    Box box;
    for (const Vec3& p : points) box.grow(p);
    return box;
}

}  // namespace swage
