// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh's own surface where matter broke by load: parted half-way between particles whose
// connection broke, each side following its own matter, and closed by new faces.
#pragma once

#include "geometry/trimesh.h"
#include "skin/mount.h"

namespace swage {

struct BrokenSkin {
    TriMesh mesh;  // positions at molding; new faces have the material kCutMaterial and no texture
    Mount mount;
    int faces = 0;       // triangles of the break, both sides together
    int open_faces = 0;  // squares and edges where the surface is not closed: left open
};

// Whether any connection along the lattice's axes broke by load.
bool is_broken(const Aggregate& matter);

// `whole`: the skin while it was, its positions those at molding, and its mount. A crack that ends
// inside the body is a slit there, its two faces joined at its end. Old vertices keep their
// numbers. `roughness`: as SkinSettings has it; where new vertices lie hangs on nothing else that
// broke. `bounds_matter`: else it is some other surface within the body.
BrokenSkin break_skin(const TriMesh& whole, const Mount& mount, const Aggregate& matter,
                      double roughness = 0, bool bounds_matter = true);

}  // namespace swage
