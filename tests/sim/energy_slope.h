// SPDX-License-Identifier: GPL-3.0-or-later
// For tests that forces are minus the slope of their energy.
#pragma once

#include "sim/lattice_forces.h"

namespace swage::test {

// Of the elastic energy with one coordinate of a particle, to fourth order of the step `h` [J/m].
inline double energy_slope(LatticeForces& forces, Aggregate matter, std::size_t particle, int axis,
                           double h) {
    const Vec3 here = matter.particle_position.at(particle);
    const auto at = [&](double by) {
        matter.particle_position.set(particle, here + by * Vec3::Unit(axis));
        return forces.elastic_energy(matter);
    };
    return (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
}

}  // namespace swage::test
