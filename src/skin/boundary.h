// SPDX-License-Identifier: GPL-3.0-or-later
// A skin made anew from what exists (S1.12, S1.13): the particles at the boundary, joined to a
// closed surface wherever they adjoin by a connection. Severed pieces get surfaces of their own,
// so that a cut body shows its inner faces.
#pragma once

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/mount.h"
#include "skin/new_look.h"

namespace swage {

struct BoundarySkin {
    TriMesh mesh;  // positions at molding
    Mount mount;
};

// Closed and oriented. Looks as `look` has it; without that it has two materials, "boundary" and
// kCutMaterial, which faces have where matter was severed. Its volume at molding is the matter's.
// Pieces that hold next to no material are left out. Only what hangs together with what counts, not
// where it is. `roughness`: as SkinSettings has it.
BoundarySkin boundary_skin(const Aggregate& matter, const NewLook* look = nullptr,
                           double roughness = 0);

}  // namespace swage
