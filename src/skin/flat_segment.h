// SPDX-License-Identifier: GPL-3.0-or-later
// Points and segments in a plane.
#pragma once

#include <algorithm>

#include "base/math.h"

namespace swage {

inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

// How far along a segment the place nearest to a point is; 0 to 1.
inline double share_along(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 way = b - a;
    const double length2 = way.squaredNorm();
    return length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0.0;
}

inline double distance2_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    return (p - a - share_along(p, a, b) * (b - a)).squaredNorm();
}

}  // namespace swage
