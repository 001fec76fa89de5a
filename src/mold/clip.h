// SPDX-License-Identifier: GPL-3.0-or-later
// Convex polygons cut by the planes of a unit grid.
// Source: I. Sutherland and G. Hodgman, "Reentrant polygon clipping", 1974.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "base/whole.h"

namespace swage {

// A triangle cut by two planes along each axis has nine corners at most.
struct ClipPolygon {
    static constexpr int kLimit = 16;
    std::array<Vec3, kLimit> corner;
    int count = 0;

    void add(const Vec3& p) {
        // Round-off can add crossings without area to a polygon that lies in the plane.
        if (count < kLimit) corner[count++] = p;
    }
};

// The parts at and below, at and above the plane. A crossing is computed from the lower end
// of its edge, so that both neighbours of an edge find the same point.
inline void split(const ClipPolygon& whole, int axis, double plane, ClipPolygon& low,
                  ClipPolygon& high) {
    low.count = high.count = 0;
    for (int n = 0; n < whole.count; ++n) {
        const Vec3& a = whole.corner[n];
        const Vec3& b = whole.corner[n + 1 == whole.count ? 0 : n + 1];
        if (a[axis] <= plane) low.add(a);
        if (a[axis] >= plane) high.add(a);
        if ((a[axis] < plane) == (b[axis] < plane) || a[axis] == plane || b[axis] == plane)
            continue;
        const Vec3& from = a[axis] < b[axis] ? a : b;
        const Vec3& to = a[axis] < b[axis] ? b : a;
        Vec3 crossing = from + (plane - from[axis]) / (to[axis] - from[axis]) * (to - from);
        crossing[axis] = plane;
        low.add(crossing);
        high.add(crossing);
    }
}

struct BinRange {
    int first, last;
};

// Bins that a part of a surface spans along one axis. One that lies in a plane between two bins
// belongs to the bin behind it, where the material is.
inline BinRange bins_between(double low, double high, double normal, int bin_count) {
    int first = to_int(std::floor(low));
    int last = to_int(std::ceil(high) - 1);
    if (last < first) first = last = normal > 0 ? last : first;  // in a plane
    return {std::clamp(first, 0, bin_count - 1), std::clamp(last, 0, bin_count - 1)};
}

inline BinRange bins_of(const ClipPolygon& polygon, int axis, const Vec3& normal, int bin_count) {
    double low = polygon.corner[0][axis], high = low;
    for (int n = 1; n < polygon.count; ++n) {
        low = std::min(low, polygon.corner[n][axis]);
        high = std::max(high, polygon.corner[n][axis]);
    }
    return bins_between(low, high, normal[axis], bin_count);
}

// Cuts `polygon` along one axis and calls act(bin, part) for each bin of [only.first, only.last].
// The polygon is used up.
template <typename Act>
void for_each_bin(ClipPolygon& polygon, int axis, const Vec3& normal, int bin_count,
                  const BinRange& only, const Act& act) {
    if (polygon.count < 3) return;
    BinRange range = bins_of(polygon, axis, normal, bin_count);
    ClipPolygon part, rest;
    if (range.first < only.first) {
        if (range.last < only.first) return;
        split(polygon, axis, only.first, part, rest);
        polygon = rest;
        range.first = only.first;
    }
    for (int bin = range.first; bin <= std::min(range.last, only.last); ++bin) {
        if (bin == range.last) {
            if (polygon.count >= 3) act(bin, polygon);
            return;
        }
        split(polygon, axis, bin + 1, part, rest);
        if (part.count >= 3) act(bin, part);
        polygon = rest;
        if (polygon.count < 3) return;
    }
}

}  // namespace swage
