// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/internal_damping.h"

#include <algorithm>
#include <cmath>

namespace swage {

// A cantilever's first mode: w = 3.516 sqrt(E I / rho A) / L^2, for a square section 1.015 c h /
// L^2.
double slowest_frequency(const Aggregate& matter) {
    const Vec3 size = matter.lattice.spacing * matter.lattice.cell_count.cast<double>();
    const double density =
        matter.inset.empty() ? matter.material.density : matter.mass() / matter.volume();
    const double speed = std::sqrt(matter.mean_modulus() / density);
    return speed * size.minCoeff() / (size.maxCoeff() * size.maxCoeff());
}

double largest_damping_ratio(const Aggregate& matter) {
    double largest = 0;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        largest = std::max(largest, matter.material_at(m).damping_ratio);
    }
    return largest;
}

InternalDamping::InternalDamping(const Aggregate& matter, double highest) {
    for (const DampedMaterials& of : damped_materials(matter)) {
        part_.push_back(
            {damping_branches(of.damping_ratio, slowest_frequency(matter), highest), {}});
    }
}

void InternalDamping::add_stiffness_bound(const Aggregate& matter,
                                          std::vector<double>& bound) const {
    const std::vector<DampedMaterials> damped = damped_materials(matter);
    for (std::size_t n = 0; n < part_.size(); ++n) {
        const std::vector<double> more = stiffness_bound(
            matter, lattice_law(matter), ConnectionShares(matter, damped[n].counts));
        for (std::size_t p = 0; p < bound.size(); ++p) {
            bound[p] += (fast_stiffness(part_[n].branches) - 1) * more[p];
        }
    }
}

std::vector<BranchStep> InternalDamping::step(const Aggregate& matter, LatticeForces& lattice,
                                              double duration) {
    std::vector<BranchStep> steps;
    for (std::size_t n = 0; n < part_.size(); ++n) {
        auto& [branches, strain] = part_[n];
        strain.resize(lattice.sweep(matter, n).branch_floats(branches.count));
        BranchStep step{.count = branches.count, .step = duration, .strain = &strain};
        for (int j = 0; j < branches.count; ++j) {
            step.forward[j] =
                duration > 0 ? damping_step(branches, j, duration) : DampingStep{1.0, 0.0};
        }
        steps.push_back(step);
    }
    return steps;
}

void InternalDamping::let_go() {
    for (Part& part : part_) part.strain.clear();
}

double InternalDamping::stored_energy(const Aggregate& matter, LatticeForces& lattice) const {
    double stored = 0;
    for (std::size_t n = 0; n < part_.size(); ++n) {
        const auto& [branches, strain] = part_[n];
        if (strain.empty()) continue;
        stored +=
            lattice.sweep(matter, n).branch_energy(matter, lattice_law(matter), branches, strain);
    }
    return stored;
}

}  // namespace swage
