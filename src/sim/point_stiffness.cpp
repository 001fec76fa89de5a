// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/point_stiffness.h"

#include <limits>

#include "sim/limited_stiffness.h"
#include "sim/surface_forces.h"

namespace swage {

PointStiffness::PointStiffness(const Aggregate& matter, const SurfacePoints& points,
                               const OtherSide& other, Solver solver)
    : on(other),
      asked(stiffness_on_body(matter, points, other.give, other.spacing, other.scale, solver)) {
    for (std::size_t p = 0; p < points.size(); ++p) {
        hold.push_back(other.hold * area_on(other.spacing, points, p));
    }
    if (!(other.most > 0)) {
        stiffest.assign(points.size(), std::numeric_limits<double>::infinity());
        return;
    }
    // Half of which acts where the other way does as much.
    stiffest = stiffest_of_points(matter, points, asked, other.most);
    if (!other.is_itself) borne = share_borne(matter, points, asked, other.most);
}

}  // namespace swage
