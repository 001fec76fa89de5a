// SPDX-License-Identifier: GPL-3.0-or-later
// Closing cracks between border vertices that all but coincide.
#pragma once

#include <cstddef>

#include "geometry/trimesh.h"

namespace swage {

struct Stitching {
    std::size_t merged = 0;                     // vertices; 0: nothing was done
    double gap = 0;                             // [m], no two of them further apart
    std::size_t odd_before = 0, odd_after = 0;  // edges with an odd number of triangles
};

// Merges vertices at borders, within one gap after the other, where that closes edges. What is
// merged is nearer to each other than to the next vertices along the border, by far: so both sides
// of a crack are, on one loop or on two, and no rim shrinks, however fine it is.
Stitching stitch_borders(TriMesh& mesh);

}  // namespace swage
