// SPDX-License-Identifier: GPL-3.0-or-later
// A skin cut ahead of a blade, so that every side of the cut has its own vertices and a closed
// surface. Until the matter is severed the two sides coincide and nothing is to be seen.
#pragma once

#include <array>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/insides.h"
#include "skin/mount.h"

namespace swage {

struct CutResult {
    int cuts = 0;             // paths along which the skin was split
    int open_parts = 0;       // closed surfaces are capped, others stay open
    bool has_folded = false;  // a sweep turns back over itself: the skin was not split along it
};

// Splits `mesh` (its positions are those at molding) along everything that the blades will sweep,
// and extends the mount. `position`: of the vertices now [m]. `sweep`: triangles in the world of
// now that share their corners to the bit, for all of the way from where they first reach the
// matter. Near a path that bends edges are halved until its line can bend with it. Attributes are
// carried on; caps get the material kCutMaterial, or the look of the one of `insides` that they
// show, and no texture coordinates. Existing vertices keep their numbers.
CutResult cut_skin(TriMesh& mesh, const std::vector<Vec3>& position, Mount& mount,
                   const Aggregate& matter, const std::vector<std::array<Vec3, 3>>& sweep,
                   const Insides& insides = {});

// Removes triangles whose corners follow different pieces of the matter: what is left to do after a
// blade whose sweep turns back over itself.
void remove_torn_triangles(TriMesh& mesh, const Mount& mount, const Aggregate& matter);

}  // namespace swage
