// SPDX-License-Identifier: GPL-3.0-or-later
// Places of a body that no skin tells the side of, as gauges, ahead of a blade.
#pragma once

#include <array>
#include <vector>

#include "geometry/box.h"
#include "matter/aggregate.h"
#include "skin/blade_path.h"
#include "skin/mount.h"

namespace swage {

// The paths along which a skin is cut: as the blade goes, which never runs exactly through a
// particle. `box`: of what may be parted.
BladePaths paths_between_particles(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                                   double spacing);

// Corners of the cell that lie on this side of a path now, 1 or -1.
CornerMask corners_on_side(const Aggregate& matter, CellId cell, const BladePath& path, int own);

// Each place goes with the matter on its own side of all that the blades will sweep, as vertices
// that cut_skin() cuts. What a path that folds parts keeps to the corner next to it.
void keep_to_sides(Mount& mount, const Aggregate& matter,
                   const std::vector<std::array<Vec3, 3>>& sweep, const Box& box);

}  // namespace swage
