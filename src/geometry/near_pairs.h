// SPDX-License-Identifier: GPL-3.0-or-later
// Which points lie in which boxes, by two searches that find the same pairs: a grid whose bins are
// as wide as a box, and trees of spheres (S0.9). Both linear in points and boxes of like size.
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
std::vector<NearPair> near_pairs_by_spheres(const std::vector<Vec3>& point,
                                            const std::vector<Box>& box);

}  // namespace swage
