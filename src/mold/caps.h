// SPDX-License-Identifier: GPL-3.0-or-later
// Closing what a surface leaves open, so that it has an inside.
#pragma once

#include <vector>

#include "geometry/trimesh.h"

namespace swage {

struct HoleCaps {
    std::vector<Vec3> apex;         // one a hole: the middle of its rim
    std::vector<Corners> triangle;  // ids past the mesh's positions mean an apex
};

// Cones over all holes. With them every edge is run along as often forward as backward: the
// surface has no boundary, whatever else is wrong with it. A flat hole is closed exactly.
HoleCaps caps_over_holes(const TriMesh& mesh);

// Positions and triangles only.
TriMesh with_caps(const TriMesh& mesh, const HoleCaps& caps);

}  // namespace swage
