// SPDX-License-Identifier: GPL-3.0-or-later
// A solid cut down to a box.
#pragma once

#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

// What of a closed surface lies in the box, closed as it was; of its own vertices those in the box
// keep their numbers. What reaches out is laid flat onto the box's sides, where it may lie double
// or have no area: it encloses what the cut does. Positions and triangles only.
TriMesh clipped_to_box(const TriMesh& mesh, const Box& box);

}  // namespace swage
