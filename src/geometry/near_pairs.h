// SPDX-License-Identifier: GPL-3.0-or-later
// Which points lie in which boxes, by a grid whose bins are as wide as a box: linear in points and
// boxes of like size. It is tested and timed against trees of spheres (S0.9,
// tests/shared/sphere_pairs.h).
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"

namespace swage {

struct NearPair {
    int point, box;
    bool operator==(const NearPair&) const = default;
};

// Sorted by point, then box. Boxes with corners that are not finite hold nothing.
std::vector<NearPair> near_pairs(const std::vector<Vec3>& point, const std::vector<Box>& box);

}  // namespace swage
