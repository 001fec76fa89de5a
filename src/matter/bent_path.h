// SPDX-License-Identifier: GPL-3.0-or-later
// The path of a blade that is not flat, told from the planes at the connections that it severed. As
// a height over its tangent plane at the foot of a place, weighed to what lies within a cell and a
// quarter of that: the slopes tell how it bends, and what the heights are off that where it is. It
// is the same for what lies on either side. Exact for planes; on a cylinder of six cells' radius
// within 0.002 cells.
#pragma once

#include <span>
#include <vector>

#include "matter/cut_planes.h"

namespace swage {

// Whether some of these go on from one of those planes, but bent.
bool bends(std::span<const CutPlane> planes, std::span<const CutPlane> near);

// Of up to so many paths, each of what goes on from one plane to the next, the tangent planes at
// the foot of the place; by the nearest of `near`, which begins with the nearest.
std::vector<CutPlane> bent_paths(const Vec3& place, std::span<const CutPlane> near,
                                 std::size_t most);

}  // namespace swage
