// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/internal_damping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"

namespace swage {

namespace {

bool any(const SlabGrowths& growths) {
    for (const RestGrowths& part : growths) {
        for (const auto& along : part) {
            if (!along.empty()) return true;
        }
    }
    return false;
}

double yield_strain(const Aggregate& matter) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& material = matter.material_at(m);
        least = std::min(least, material.yield_stress / material.young_modulus);
    }
    return least;
}

void clear(SlabGrowths& growths) {
    for (RestGrowths& part : growths) {
        for (auto& along : part) along.clear();
    }
}

}  // namespace

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
    for (const BranchMemory& memory : matter.branch_memory) branches_.push_back(memory.branches);
    if (acts()) return;
    for (const DampedMaterials& of : damped_materials(matter)) {
        branches_.push_back(damping_branches(of.damping_ratio, slowest_frequency(matter), highest));
    }
}

void InternalDamping::add_stiffness_bound(const Aggregate& matter,
                                          std::vector<double>& bound) const {
    const std::vector<DampedMaterials> damped = damped_materials(matter);
    for (std::size_t n = 0; n < branches_.size(); ++n) {
        const std::vector<double> more =
            stiffness_bound(matter, ConnectionShares(matter, damped[n].counts));
        for (std::size_t p = 0; p < bound.size(); ++p) {
            bound[p] += (fast_stiffness(branches_[n]) - 1) * more[p];
        }
    }
}

void InternalDamping::take_growths(const Aggregate& matter) {
    if (!any(taken_) && !any(growths_)) return;
    parallel_for(kForwardCount, [&](std::size_t d) {
        grown_[d].resize(matter.particle_count() + kLanes);
        for (const RestGrowths& part : taken_) {
            for (const RestGrowth& one : part[d]) grown_[d][one.lower] = 0;
        }
        for (const RestGrowths& part : growths_) {
            for (const auto& [lower, by] : part[d]) {
                const float weight = matter.connection[d].weight[lower];
                if (weight > 0) grown_[d][lower] += by / weight;
            }
        }
    });
    std::swap(taken_, growths_);
    clear(growths_);
}

std::vector<BranchStep> InternalDamping::step(Aggregate& matter, LatticeForces& lattice,
                                              double duration) {
    if (duration > 0) take_growths(matter);
    const bool flowed = duration > 0 && any(taken_);
    std::vector<BranchStep> steps;
    matter.branch_memory.resize(branches_.size());
    for (std::size_t n = 0; n < branches_.size(); ++n) {
        auto& [branches, strain] = matter.branch_memory[n];
        branches = branches_[n];
        strain.resize(lattice.sweep(matter, n).branch_floats(branches.count));
        BranchStep step{.count = branches.count, .step = duration, .strain = &strain};
        if (flowed) step.grown = &grown_, step.yield_strain = yield_strain(matter);
        for (int j = 0; j < branches.count; ++j) {
            step.forward[j] =
                duration > 0 ? damping_step(branches, j, duration) : DampingStep{1.0, 0.0};
        }
        steps.push_back(step);
    }
    return steps;
}

void InternalDamping::let_go(Aggregate& matter) {
    matter.branch_memory.clear();
    clear(growths_);
}

double InternalDamping::stored_energy(const Aggregate& matter, LatticeForces& lattice) const {
    double stored = 0;
    for (std::size_t n = 0; n < matter.branch_memory.size(); ++n) {
        const auto& [branches, strain] = matter.branch_memory[n];
        if (strain.empty()) continue;
        stored += lattice.sweep(matter, n).branch_energy(matter, branches, strain);
    }
    return stored;
}

}  // namespace swage
