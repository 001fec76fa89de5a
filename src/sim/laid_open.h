// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of whole cells that look at cells no longer whole: what a body that has been cut or
// broken turns to a medium, and to a pressure all round, there.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Of a face the body fills a share,
//
//     s = f -+ A / 2a^2,                0 to 1
//
// f the cell's fill and A, along the face's normal, what its surface points' area vectors sum to:
// both faces across and the surface between them close, and their mean is f, as in a prism.
struct OpenFace {
    using IsPlain = OpenFace;
    std::array<ParticleId, 4> corner;  // the outside sees them counter-clockwise
    double share;                      // s

    Vec3 mean(const Vec3Array& of) const {
        return 0.25 * (of.at(corner[0]) + of.at(corner[1]) + of.at(corner[2]) + of.at(corner[3]));
    }
    // Outward area vector as it is now [m2].
    Vec3 outward(const Vec3Array& position) const {
        const Vec3 one = position.at(corner[2]) - position.at(corner[0]);
        return 0.5 * share * one.cross(position.at(corner[3]) - position.at(corner[1]));
    }
};

// In the order of their cells; none of a body whose cells are all whole.
std::vector<OpenFace> laid_open(const Aggregate& matter);

// Adds a force on the face to the particles that carry it.
inline void spread(const OpenFace& face, const Vec3& f, Vec3Array& force) {
    for (ParticleId p : face.corner) force.add(p, 0.25 * f);
}

}  // namespace swage
