// SPDX-License-Identifier: GPL-3.0-or-later
// For tests that forces are minus the slope of their energy, and in balance.
#pragma once

#include "sim/lattice_forces.h"

namespace swage::test {

// Of energy(matter) with one coordinate of a particle, to fourth order of the step `h` [J/m].
template <typename Energy>
double slope_of(const Energy& energy, Aggregate& matter, std::size_t particle, int axis, double h) {
    const Vec3 here = matter.particle_position.at(particle);
    const auto at = [&](double by) {
        matter.particle_position.set(particle, here + by * Vec3::Unit(axis));
        return energy(matter);
    };
    const double slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    matter.particle_position.set(particle, here);
    return slope;
}
inline double energy_slope(LatticeForces& forces, Aggregate matter, std::size_t particle, int axis,
                           double h) {
    return slope_of([&](const Aggregate& m) { return forces.elastic_energy(m); }, matter, particle,
                    axis, h);
}

struct Balance {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double size = 0;  // sum of the forces' lengths
};
inline Balance balance_of(const Aggregate& matter, const Vec3Array& force) {
    Balance sum;
    for (std::size_t p = 0; p < force.size(); ++p) {
        sum.force += force.at(p);
        sum.moment += matter.particle_position.at(p).cross(force.at(p));
        sum.size += force.at(p).norm();
    }
    return sum;
}

}  // namespace swage::test
