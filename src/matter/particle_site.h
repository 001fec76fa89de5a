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

}  // namespace swage
