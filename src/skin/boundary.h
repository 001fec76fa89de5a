// SPDX-License-Identifier: GPL-3.0-or-later
// A skin made anew from what exists (S1.12, S1.13): the particles at the boundary, joined to a
// closed surface wherever they adjoin by a connection. Severed pieces get surfaces of their own,
// so that a cut body shows its inner faces.
#pragma once

#include "geometry/trimesh.h"
#include "matter/aggregate.h"

namespace swage {

// Closed and oriented, in the world of now. Two materials: "boundary", and "cut" for faces where
// matter was severed. Its volume at molding is the matter's. Pieces that hold next to no material
// are left out.
TriMesh boundary_skin(const Aggregate& matter);

}  // namespace swage
