// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/surface_forces.h"

#include <cmath>

namespace swage {

std::vector<double> stiffest_of_points(const Aggregate& matter, const SurfacePoints& points,
                                       const std::vector<double>& stiffness, double most) {
    std::vector<double> carried(matter.particle_count(), 0.0);
    for (std::size_t p = 0; p < points.size(); ++p) {
        const SurfacePoints::Carriers by = points.carriers(p);
        for (int c = 0; c < 8; ++c) {
            carried[by.corner[c]] += std::sqrt(stiffness[p]) * std::abs(by.weight[c]);
        }
    }
    std::vector<double> stiffest;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const SurfacePoints::Carriers by = points.carriers(p);
        double row = 0;  // over the root of the point's own stiffness
        for (int c = 0; c < 8; ++c) {
            row +=
                std::abs(by.weight[c]) * carried[by.corner[c]] / matter.particle_mass[by.corner[c]];
        }
        stiffest.push_back(row > 0 ? std::sqrt(stiffness[p]) * most / row
                                   : std::numeric_limits<double>::infinity());
    }
    return stiffest;
}

}  // namespace swage
