// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies for these tests: surface points only, each carried by a particle of its own.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "machines/machine_spec.h"
#include "matter/aggregate.h"

namespace swage {

// `points` lie on the sites of some lattice.
inline Aggregate body_of(const std::vector<Vec3>& points, double spacing) {
    Aggregate body;
    Lattice sites;
    Vec3 low = points[0], step = Vec3::Constant(std::numeric_limits<double>::infinity());
    for (const Vec3& x : points) low = low.cwiseMin(x);
    for (const Vec3& x : points) {
        for (int d = 0; d < 3; ++d) {
            const double way = x[d] - low[d];
            if (way > 1e-6 * spacing) step[d] = std::min(step[d], way);
        }
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3i at = ((points[p] - low).cwiseQuotient(step)).array().round().cast<int>();
        sites.particle_run.push_back({at.x(), at.y(), at.z(), ParticleId(p), 1});
    }
    body.particle_reference = ReferencePlaces(low, step, sites);
    body.lattice.spacing = spacing;
    body.particle_position.resize(points.size());
    body.particle_mass.resize(points.size(), 1.0);
    for (std::size_t p = 0; p < points.size(); ++p) {
        body.particle_position.set(p, points[p]);
        body.surface.add_loose(static_cast<ParticleId>(p), spacing * spacing, Vec3::UnitX());
    }
    return body;
}

// Points on the faces, edges and corners of a box, `divisions` to each side.
inline std::vector<Vec3> box_points(const Vec3& low, const Vec3& high, const Vec3i& divisions) {
    std::vector<Vec3> points;
    for (int k = 0; k <= divisions.z(); ++k) {
        for (int j = 0; j <= divisions.y(); ++j) {
            for (int i = 0; i <= divisions.x(); ++i) {
                const bool inner = i > 0 && i < divisions.x() && j > 0 && j < divisions.y() &&
                                   k > 0 && k < divisions.z();
                if (inner) continue;
                const Vec3 share(double(i) / divisions.x(), double(j) / divisions.y(),
                                 double(k) / divisions.z());
                points.push_back(low + share.cwiseProduct(high - low));
            }
        }
    }
    return points;
}

// 1 m long, 0.1 m high and wide, along `axis`, its middle at `centre`.
inline Aggregate bar(int axis = 0, const Vec3& centre = Vec3::Zero()) {
    Vec3 half = Vec3::Constant(0.05);
    Vec3i divisions = Vec3i::Constant(8);
    half[axis] = 0.5;
    divisions[axis] = 80;
    return body_of(box_points(centre - half, centre + half, divisions), 0.0125);
}

// Grips that hold the two ends of the work-piece; the second may move.
inline std::vector<GripSpec> vice_grips() {
    GripSpec hold;
    hold.name = "hold";
    hold.from = {"-length", "-height", "-width"};
    hold.to = {"-0.4*length", "height", "width"};
    GripSpec turn = hold;
    turn.name = "turn";
    turn.from[0] = "0.4*length";
    turn.to[0] = "length";
    turn.motion.axis = {"1", "0", "0"};
    return {hold, turn};
}

}  // namespace swage
