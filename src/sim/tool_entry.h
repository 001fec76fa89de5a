// SPDX-License-Identifier: GPL-3.0-or-later
// By which of a tool's surfaces a point has come in. The nearest one would let a point that is
// beyond the middle of a thin tool out on the far side: fast matter would go through. From there on
// the plane of the surface that it came in by holds, as long as its foot on that lies on the tool.
#pragma once

#include "geometry/shape.h"

namespace swage {

// Of a tool's distance, what is surely left to go: that of a mesh, found between the points of a
// grid, may change sqrt(3) times as fast as the place.
inline constexpr double kSureShare = 0.5;

// In the tool's frame. A normal of zero: none.
struct ToolEntry {
    Vec3 normal = Vec3::Zero();
    double offset = 0;  // of the plane, along the normal [m]
};

// How far off the tool the foot may lie, and how deep behind the plane the point [m].
struct EntryReach {
    double beside, deep;
};

// The distance of a point at `now` from the surface that it came in by: by `entry` or, where that
// is none, on the straight way from `from`. `entry` goes on with it.
Distance distance_by_entry(const Shape& shape, const EntryReach& reach, const Vec3& from,
                           const Vec3& now, ToolEntry& entry);

// Whether a point that came in by `entry` is out on the far side of the tool, deeper than it is
// held.
bool is_beyond(const Shape& shape, const EntryReach& reach, const Vec3& now,
               const ToolEntry& entry);

}  // namespace swage
