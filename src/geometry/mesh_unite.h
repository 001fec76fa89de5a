// SPDX-License-Identifier: GPL-3.0-or-later
// Two bodies made one, and what two have in common.
#pragma once

#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// The union of two closed, oriented surfaces that cross or touch; it may touch itself along edges.
// `origin` tells for each triangle of the result which triangle it is a piece of: t of a, or
// a.triangle.size() + t of b. No triangle is without area where that can be avoided. False when it
// cannot be made (a surface that crosses itself, say). Positions and triangles only.
bool unite(const TriMesh& a, const TriMesh& b, TriMesh& result, std::vector<int>& origin);

// The same with b larger by `grown` of the size of both: faces of the two that lie on each other
// but for rounding, and so cut each other in parts only, do so no more. To be tried in turn: as
// little as rounded numbers of 64 bits ask, or what those of a file do.
inline constexpr double kGrown[] = {2e-8, 1e-6};
bool unite_grown(const TriMesh& a, const TriMesh& b, double grown, TriMesh& result,
                 std::vector<int>& origin);

// What lies in both of two such surfaces. False when it cannot be made.
bool intersect(const TriMesh& a, const TriMesh& b, TriMesh& result);

}  // namespace swage
