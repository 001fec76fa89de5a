// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on points of the true surface.
#pragma once

#include "laws/pressure.h"
#include "matter/aggregate.h"

namespace swage {

// Outward area vector of the point's patch as it is now [m2].
inline Vec3 surface_area_vector(const Aggregate& matter, int point) {
    const SurfacePoints& surface = matter.surface;
    return present_area<double>(matter.surface_gradient(point),
                                surface.area[point] * surface.reference_normal[point]);
}

// Adds a force on the point to the particles that carry it; force and moment are kept exactly.
inline void spread(const SurfacePoints& surface, int point, const Vec3& f, Vec3Array& force) {
    for (int c = 0; c < 8; ++c) {
        force.add(surface.corner[point][c], double(surface.weight[point][c]) * f);
    }
}

}  // namespace swage
