// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies for these tests: surface points only, each carried by a particle of its own.
#pragma once

#include <vector>

#include "machines/machine_spec.h"
#include "matter/aggregate.h"

namespace swage {

inline Aggregate body_of(const std::vector<Vec3>& points, double spacing) {
    Aggregate body;
    body.lattice.spacing = spacing;
    body.particle_position.resize(points.size());
    body.particle_mass.resize(points.size(), 1.0);
    for (std::size_t p = 0; p < points.size(); ++p) {
        body.particle_position.set(p, points[p]);
        std::array<ParticleId, 8> corner;
        corner.fill(static_cast<ParticleId>(p));
        body.surface.corner.push_back(corner);
        body.surface.weight.push_back({1, 0, 0, 0, 0, 0, 0, 0});
        body.surface.area.push_back(spacing * spacing);
        body.surface.reference_position.push_back(points[p]);
        body.surface.reference_normal.push_back(Vec3::UnitX());
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
    turn.motion.axis = Vec3::UnitX();
    return {hold, turn};
}

}  // namespace swage
