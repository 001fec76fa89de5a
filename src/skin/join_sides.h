// SPDX-License-Identifier: GPL-3.0-or-later
// The two sides of a cut as one surface: who is whose vertex.
#pragma once

#include <set>

#include "skin/cap_front.h"
#include "skin/surface_split.h"

namespace swage {

// Corners are joined across all edges but the seams; at a seam, surface joins cap, each on its own
// side. Every set of joined corners is a vertex, so the result is manifold, and where the blade
// stops inside the body the last vertices stay shared. Numbers the triangles' corners of `parts`,
// raw, all others being old vertices that keep their numbers, and tells what is added and at the
// seams.
void join_sides(const std::set<int>& parts, const std::set<Ends>& seams, int old_count,
                SurfaceSplit& split);

}  // namespace swage
