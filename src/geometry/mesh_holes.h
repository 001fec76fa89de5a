// SPDX-License-Identifier: GPL-3.0-or-later
// Holes of a surface, closed; and open sheets, which are no body with holes, left out.
#pragma once

#include <cstddef>

#include "geometry/trimesh.h"

namespace swage {

struct HolesClosed {
    std::size_t holes = 0, edges = 0, triangles = 0;  // closed, their edges, what closes them
    double share = 0;                                 // of the whole surface after that
    std::size_t failed = 0;                           // holes that could not be closed
    std::size_t sheets = 0, sheet_triangles = 0;      // left out
    double sheet_share = 0;                           // of the surface as given
};

// Throws Error(mesh) where open sheets are too much of the mesh to be left out.
HolesClosed close_holes(TriMesh& mesh);

}  // namespace swage
