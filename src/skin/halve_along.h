// SPDX-License-Identifier: GPL-3.0-or-later
// The line along which a path that bends cuts a mesh has a corner at each edge that it crosses:
// edges beside it are halved first.
#pragma once

#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/blade_path.h"
#include "skin/mount.h"

namespace swage {

// No triangle that the path may cross has an edge above `longest` [m] then. `position`: of the
// vertices now [m]. Old vertices keep their numbers and places.
void halve_edges_along(const BladePath& path, double longest, TriMesh& mesh,
                       std::vector<Vec3>& position, Mount& mount, const Aggregate& matter);

}  // namespace swage
