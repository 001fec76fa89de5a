// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on points of the true surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "laws/pressure.h"
#include "matter/aggregate.h"

namespace swage {

// Outward area vector of the point's patch as it is now [m2].
inline Vec3 surface_area_vector(const Aggregate& matter, int point) {
    const SurfacePoints& surface = matter.surface;
    return present_area<double>(matter.surface_gradient(point),
                                surface.area(point) * surface.normal(point));
}

// Mass of the lightest particle that carries a good share of the point [kg].
inline double lightest_carrier(const Aggregate& matter, const SurfacePoints& points,
                               std::size_t point) {
    const SurfacePoints::Carriers by = points.carriers(point);
    double lightest = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 8; ++c) {
        if (by.weight[c] <= 0.05) continue;
        lightest = std::min(lightest, matter.particle_mass[by.corner[c]]);
    }
    return lightest;
}

inline double lightest_carrier(const Aggregate& matter, std::size_t point) {
    return lightest_carrier(matter, matter.surface, point);
}

// What points that touch tools, that are gripped and that meet another body may add to the square
// of a swing by which steps go in turns, 4.
inline constexpr double kTouchShare = 0.5, kGripShare = 1, kMeetShare = 1;

// How stiff points may push [N/m], in proportion to `stiffness`, if all of them together are to
// make no particle swing faster than sqrt(most) [rad/s]: their Gram matrix, G_ij = sqrt(k_i k_j)
// sum_c w_ic w_jc / m_c, has the same largest eigenvalue as what they do to the particles, and
// D^-1/2 G D^-1/2 has none above one, D being the sums of G's rows.
std::vector<double> stiffest_of_points(const Aggregate& matter, const SurfacePoints& points,
                                       const std::vector<double>& stiffness, double most);

// Adds to each particle that carries the point what its stiffness is there, at most [N/m].
inline void spread_stiffness(const SurfacePoints& surface, int point, double k,
                             std::vector<double>& stiffness) {
    const SurfacePoints::Carriers by = surface.carriers(static_cast<std::size_t>(point));
    for (int c = 0; c < 8; ++c) stiffness[by.corner[c]] += std::abs(by.weight[c]) * k;
}

// Adds a force on the point to the particles that carry it; force and moment are kept exactly.
inline void spread(const SurfacePoints& surface, int point, const Vec3& f, Vec3Array& force) {
    const SurfacePoints::Carriers by = surface.carriers(point);
    for (int c = 0; c < 8; ++c) force.add(by.corner[c], by.weight[c] * f);
}

}  // namespace swage
