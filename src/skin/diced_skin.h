// SPDX-License-Identifier: GPL-3.0-or-later
// A skin whose triangles are split along the planes half-way between the particles' sites, so that
// each belongs to one particle: where matter breaks between two of them, the skin can part.
#pragma once

#include <functional>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/middle_planes.h"

namespace swage {

// The site of triangles that were left whole: far from all others.
inline const Vec3i kNoSite = Vec3i::Constant(1 << 18);

struct DicedSkin {
    TriMesh mesh;  // positions at molding; the old vertices first
    MiddlePlanes planes;
    std::vector<std::array<int, 3>> plane;  // a vertex each: middle plane that it was made on, by
                                            // axis, or kNoPlane
    std::vector<int> on_triangle;           // a vertex each beyond the old: of the old mesh
    std::vector<Vec3i> site;                // a triangle each: in the cube around this site
};

// `mesh`: positions at molding. What it carries (texture coordinates, smoothing, colours,
// materials, parts) goes on linearly over the parts. A triangle with no part in a cube that is
// `wanted` stays whole, but for what its neighbours' new vertices on its edges ask.
DicedSkin dice_skin(const TriMesh& mesh, const Lattice& lattice,
                    const std::function<bool(const Vec3i&)>& wanted);

}  // namespace swage
