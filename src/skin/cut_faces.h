// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth surfaces through severed connections.
#pragma once

#include <optional>
#include <vector>

#include "matter/aggregate.h"
#include "skin/voxel_surface.h"

namespace swage {

struct CutTarget {
    Vec3 normal;    // unit
    double height;  // normal . x on the target plane [m]
};

// For each site the plane that its part of a cut face should lie in; none off the cuts and in
// rubble.
std::vector<std::optional<CutTarget>> cut_targets(const Aggregate& matter,
                                                  const VoxelSurface& surface,
                                                  const std::vector<Vec3>& place);

// The cut near a particle's site, as spacings from the lattice's origin; nothing where no plane
// parts what is severed there.
std::optional<CutTarget> cut_plane_near(const Aggregate& matter, const Vec3i& site);

}  // namespace swage
