// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/surface_forces.h"

#include <cmath>

namespace swage {

bool is_torn(const Aggregate& matter, std::size_t point) {
    constexpr double kCarries = 1e-6;
    if (!is_parted(matter, point)) return false;
    const SurfacePoints::Carriers by = matter.surface.carriers(point);
    std::array<unsigned, 8> group;
    for (unsigned c = 0; c < 8; ++c) group[c] = 1u << c;
    unsigned carry = 0;
    for (unsigned c = 0; c < 8; ++c) carry |= unsigned(std::abs(by.weight[c]) > kCarries) << c;
    for (const CellConnection& link : kCellConnection) {
        const ParticleId lower = by.corner[std::size_t(link.corner)];
        if (!(matter.connection[std::size_t(link.direction)].weight[lower] > 0)) continue;
        const unsigned joined =
            group[std::size_t(link.corner)] | group[std::size_t(upper_corner(link))];
        for (unsigned c = 0; c < 8; ++c) {
            if (joined >> c & 1) group[c] = joined;
        }
    }
    return std::any_of(group.begin(), group.end(), [&](unsigned together) {
        return (together & carry) != 0 && (together & carry) != carry;
    });
}

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
