// SPDX-License-Identifier: GPL-3.0-or-later
// What grips and blades look like. Nothing here takes part in the mechanics.
#pragma once

#include <vector>

#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

// A clamp around `held`: a plate above, a plate below (along y) and bolts between them. The plates
// stand off by `clearance` [m].
TriMesh clamp_around(const Box& held, double clearance);

// A plate of this thickness [m], ground to the edge (two points or more), reaching back from it
// for `height` [m] along `back`, with a spine at its end. `back` need not be unit or square.
TriMesh blade_behind(const std::vector<Vec3>& edge, const Vec3& back, double height,
                     double thickness);

}  // namespace swage
