// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/cell_gradient.h"

namespace swage {

Mat3 cell_gradient(const Aggregate& matter, const std::array<ParticleId, 8>& corner,
                   const Vec3& place) {
    std::array<Vec3, 8> x;
    for (int c = 0; c < 8; ++c) x[c] = matter.particle_position.at(corner[c]);
    Mat3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3 slope = Vec3::Zero();
        for (int q = 0; q < 4; ++q) {
            const int low = (q & 1) << u | (q >> 1) << v;
            const double share =
                (q & 1 ? place[u] : 1 - place[u]) * (q & 2 ? place[v] : 1 - place[v]);
            slope += share * (x[low | 1 << axis] - x[low]);
        }
        gradient.col(axis) = slope / matter.lattice.spacing;
    }
    return gradient;
}

}  // namespace swage
