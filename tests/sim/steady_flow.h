// SPDX-License-Identifier: GPL-3.0-or-later
// A damped body that is drawn out and sheared on and on, its volume kept, by steps of a motion that
// is given.
#pragma once

#include "sim/internal_damping.h"

namespace swage::test {

struct SteadyFlow {
    double given = 0;    // work on the branches [J]
    double stored = 0;   // what they have of it at the end [J]
    double plastic = 0;  // [J]
};

// To a stretch of exp(`strain`) along x, and as much shear, in `steps`.
inline SteadyFlow flow_steadily(Aggregate& m, double strain, int steps) {
    LatticeForces lattice(m);
    std::vector<double> bound = lattice.stiffness_bound(m);
    double highest = 0;
    for (std::size_t p = 0; p < bound.size(); ++p) {
        highest = std::max(highest, std::sqrt(bound[p] / m.particle_mass[p]));
    }
    InternalDamping damping(m, highest);
    const double dt = 0.5 / highest;
    const auto gradient = [&](double share) {
        const double s = share * strain, half = std::exp(-0.5 * s);
        Mat3 f = Vec3(std::exp(s), half, half).asDiagonal();
        f(0, 1) = f(2, 1) = s;
        return f;
    };
    SteadyFlow result;
    Vec3Array force;
    for (int n = 1; n <= steps; ++n) {
        const Mat3 now = gradient(double(n) / steps), before = gradient(double(n - 1) / steps);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 x = m.particle_reference.at(p);
            m.particle_position.set(p, now * x);
            m.particle_velocity.set(p, (now - before) * x / dt);
        }
        const std::vector<BranchStep> branches = damping.step(m, lattice, dt);
        lattice.find(m, Flow::trial, force, branches, &result.given);
        result.plastic += lattice.commit(m, Forces::fresh, damping.growths()).plastic;
    }
    result.stored = damping.stored_energy(m, lattice);
    return result;
}

}  // namespace swage::test
