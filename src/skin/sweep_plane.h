// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a plane that a blade sweeps through.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/math.h"
#include "geometry/box.h"

namespace swage {

struct SweepPlane {
    Vec3 point, normal;  // normal = across cross up
    Vec3 across, up;     // unit, in the plane
    std::vector<std::array<Vec2, 3>> triangle;
    std::vector<std::array<Vec2, 2>> outline;  // edges that only one triangle has

    double height(const Vec3& p) const { return normal.dot(p - point); }
    Vec2 flat(const Vec3& p) const { return {across.dot(p - point), up.dot(p - point)}; }
    Vec3 world(const Vec2& p) const { return point + p[0] * across + p[1] * up; }
    bool covers(const Vec2& p) const { return near(p, 0); }
    bool near(const Vec2& p, double reach) const;  // within `reach` [m] of the swept part
};

// Nothing when the triangles leave a common plane by more than `tolerance` [m], or have no area.
std::optional<SweepPlane> fit_sweep_plane(const std::vector<std::array<Vec3, 3>>& sweep,
                                          double tolerance);

// The planes that blades sweep, one each; of a path that has several, as of a blade that cuts,
// draws back, goes aside and cuts again, those that part the box.
struct SweepPlanes {
    std::vector<SweepPlane> plane;
    bool has_curved = false;
};
// `box`: of what may be parted. `tolerance`: as above.
SweepPlanes sweep_planes(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                         double tolerance);

}  // namespace swage
