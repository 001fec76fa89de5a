// SPDX-License-Identifier: GPL-3.0-or-later
// Matter of given cells, and a block of whole ones, made by hand: what tests of rooms below `mold`
// work on.
#pragma once

#include "matter/aggregate.h"

namespace swage::test {

// Particles, masses and connections with share weights for cells of the given fill, and whole
// cells' worth of everything else. Cells sorted by z, y, x.
Aggregate make_matter(const Vec3& origin, double a, const Vec3i& count,
                      const std::vector<Vec3i>& cells, const std::vector<float>& fill,
                      const Material& material = {});

// nx * ny * nz cells of edge a, centred on the origin. Four surface points a cell face.
Aggregate make_block(int nx, int ny, int nz, double a, const Material& material);

// Holds every surface point whose reference position satisfies the condition.
template <typename Condition>
std::vector<int> points_where(const Aggregate& matter, const Condition& condition) {
    std::vector<int> points;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        if (condition(matter.surface_reference(p))) points.push_back(static_cast<int>(p));
    }
    return points;
}

}  // namespace swage::test
