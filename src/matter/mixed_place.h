// SPDX-License-Identifier: GPL-3.0-or-later
// Which of its two materials a place in a mixed cell is of.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// The number of the material on that side of the boundary, which is taken as a plane. `place`: -0.5
// to 0.5 in the cell. For a plane across a box the middle of both materials' centroids, less that
// of all, is on the boundary.
inline int material_at(const MixedCell& cell, const Vec3& place) {
    const double all = double(cell.fill[0]) + double(cell.fill[1]);
    Vec3 on = Vec3::Zero();
    for (int m : {0, 1}) on += (1 - cell.fill[m] / all) * cell.centroid[m].cast<double>();
    const Vec3 normal = cell.normal.cast<double>(),
               way = (cell.centroid[1] - cell.centroid[0]).cast<double>();
    const double beyond = normal.dot(place - on);
    return cell.material[(beyond > 0) == (normal.dot(way) > 0) ? 1 : 0];
}

}  // namespace swage
