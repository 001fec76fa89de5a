// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a tool up to the work-piece.
#pragma once

#include <optional>
#include <vector>

#include "geometry/shape.h"

namespace swage {

// How far [m] along `direction` (unit; may be negative) the tool has to be moved so that, coming
// from far outside, it stops with `gap` [m] between its surface and the nearest of the points. No
// value: it passes by. The first contact counts, so that legs stop a tool before a belly does.
std::optional<double> slide_to_touch(const Shape& shape, const Pose& points_from_tool,
                                     const Vec3& direction, const std::vector<Vec3>& points,
                                     double gap);

// The smallest distance [m] of the points to the tool's surface; negative inside.
double nearest_distance(const Shape& shape, const Pose& points_from_tool,
                        const std::vector<Vec3>& points);

}  // namespace swage
