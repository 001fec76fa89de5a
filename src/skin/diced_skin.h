// SPDX-License-Identifier: GPL-3.0-or-later
// A skin whose triangles are split along the planes half-way between the particles' sites, so that
// each belongs to one particle: where matter breaks between two of them, the skin can part.
#pragma once

#include <functional>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/middle_planes.h"
#include "skin/warp.h"

namespace swage {

// The site of triangles that were left whole: far from all others.
inline const Vec3i kNoSite = Vec3i::Constant(1 << 18);

struct DicedSkin {
    TriMesh mesh;                           // positions at molding; the old vertices first
    std::vector<Vec3> straight;             // a vertex each: where it is in straight space
    MiddlePlanes planes;                    // there
    std::vector<std::array<int, 3>> plane;  // a vertex each: middle plane that it was made on, by
                                            // axis, or kNoPlane
    std::vector<int> on_triangle;           // a vertex each beyond the old: of the old mesh
    std::vector<Vec3i> site;                // a triangle each: in the cube around this site
    // The mesh before it is split along planes. With a warp its edges are divided, so that they
    // follow it.
    TriMesh straight_mesh;       // positions in straight space
    std::vector<Vec3> position;  // of its vertices, at molding
};

// `mesh`: positions at molding. What it carries (texture coordinates, smoothing, colours,
// materials, parts) goes on linearly over the parts. A triangle with no part in a cube that is
// `wanted` stays whole, but for what its neighbours' new vertices on its edges ask. New vertices
// lie on the mesh's own triangles.
DicedSkin dice_skin(const TriMesh& mesh, const Lattice& lattice, const Warp& warp,
                    const std::function<bool(const Vec3i&)>& wanted);

}  // namespace swage
