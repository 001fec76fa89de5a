// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Where on the lattice the particle was at molding.
inline Vec3i lattice_site(const Aggregate& matter, ParticleId particle) {
    const Vec3 at =
        matter.particle_reference.at(static_cast<std::size_t>(particle)) - matter.lattice.origin;
    return (at / matter.lattice.spacing).array().round().cast<int>();
}

// Of a connection between these sites, severed at this share of the way. Its normal leads away from
// the nearer end: where a path goes through a particle that tells on which side of it that is.
inline CutPoint cut_point(const Vec3i& from, const Vec3i& to, float share, const Vec3& normal) {
    const Eigen::Vector3f at = from.cast<float>() + share * (to - from).cast<float>();
    const bool is_first = share <= 0.5f, goes_on = normal.dot((to - from).cast<double>()) >= 0;
    const Eigen::Vector3f away = (is_first == goes_on ? 1 : -1) * normal.cast<float>();
    return {{at.x(), at.y(), at.z()}, {away.x(), away.y(), away.z()}};
}

}  // namespace swage
