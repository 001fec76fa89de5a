// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage::test {

// Of its particles as they move now [J].
inline double kinetic_energy(const Aggregate& matter) {
    double sum = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        sum += 0.5 * matter.particle_mass[p] * matter.particle_velocity.at(p).squaredNorm();
    }
    return sum;
}

}  // namespace swage::test
