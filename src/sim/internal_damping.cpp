// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/internal_damping.h"

#include <cmath>

namespace swage {

// A cantilever's first mode: w = 3.516 sqrt(E I / rho A) / L^2, for a square section 1.015 c h /
// L^2.
double slowest_frequency(const Aggregate& matter) {
    const Vec3 size = matter.lattice.spacing * matter.lattice.cell_count.cast<double>();
    const double speed = std::sqrt(matter.material.young_modulus / matter.material.density);
    return speed * size.minCoeff() / (size.maxCoeff() * size.maxCoeff());
}

InternalDamping::InternalDamping(const Aggregate& matter, double highest)
    : branches_(
          damping_branches(matter.material.damping_ratio, slowest_frequency(matter), highest)) {}

BranchStep InternalDamping::step(const LatticeSweep& sweep, double duration) {
    strain_.resize(sweep.branch_floats(branches_.count));
    BranchStep step{.count = branches_.count, .step = duration, .strain = &strain_};
    for (int j = 0; j < branches_.count; ++j) {
        step.forward[j] =
            duration > 0 ? damping_step(branches_, j, duration) : DampingStep{1.0, 0.0};
    }
    return step;
}

double InternalDamping::stored_energy(const Aggregate& matter, const LatticeSweep& sweep) const {
    if (strain_.empty()) return 0;
    double sum = 0;
    const double k = lattice_law(matter).stiffness;
    sweep.for_each_branched(strain_, branches_.count, [&](ParticleId p, const float* strain) {
        for (int d = 0; d < kForwardCount; ++d) {
            const double length = reference_length(matter.lattice, d);
            const double scale = k * length * length * sweep.branch_weight(matter, d)[p];
            for (int j = 0; j < branches_.count; ++j) {
                const double m = strain[(d * branches_.count + j) * kLanes];
                sum += scale * m * m / (2 * branches_.share[j]);
            }
        }
    });
    return sum;
}

}  // namespace swage
