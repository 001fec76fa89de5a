// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/internal_damping.h"

#include <cmath>
#include <numeric>

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
    const double k = lattice_law(matter).stiffness;
    double scale[kForwardCount], share[kMostBranches];
    for (int d = 0; d < kForwardCount; ++d) {
        const double length = reference_length(matter.lattice, d);
        scale[d] = 0.5 * k * length * length;
    }
    for (int j = 0; j < branches_.count; ++j) share[j] = 1 / branches_.share[j];
    double sum[kLanes] = {};
    sweep.for_each_branched(
        strain_, branches_.count,
        [&](ParticleId, int count, const float* strain, const float* weight) {
            for (int d = 0; d < kForwardCount; ++d) {
                double square[kLanes] = {};
                for (int j = 0; j < branches_.count; ++j, strain += kLanes) {
                    for (int l = 0; l < kLanes; ++l) {
                        square[l] += share[j] * (double(strain[l]) * double(strain[l]));
                    }
                }
                for (int l = 0; l < count; ++l) {
                    const double whole = weight == nullptr ? 1 : double(weight[d * kLanes + l]);
                    sum[l] += scale[d] * whole * square[l];
                }
            }
        });
    return std::accumulate(sum, sum + kLanes, 0.0);
}

}  // namespace swage
