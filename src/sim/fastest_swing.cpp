// SPDX-License-Identifier: GPL-3.0-or-later
// Source: C. Lanczos, 1950, on M^-1/2 K M^-1/2; its largest eigenvalue comes out first, so that
// vectors need not be kept nor made orthogonal again. Expected error from a random start: Kuczynski
// & Wozniakowski, 1992.
#include "sim/fastest_swing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/noise.h"
#include "sim/lattice_sweep.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kProducts = 24;
constexpr double kRoom = 2.0;    // what pressed matter may become stiffer by
constexpr double kNudge = 1e-6;  // [spacings], the farthest that any particle is moved

template <typename Act>
void for_each_particle(std::size_t count, const Act& act) {
    for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) act(p);
    });
}

Aggregate as_molded(Aggregate matter) {
    matter.particle_position = matter.particle_reference.all();
    matter.material.yield_stress = std::numeric_limits<double>::infinity();
    for (Material& inset : matter.inset) inset.yield_stress = matter.material.yield_stress;
    matter.cell_history.clear();
    matter.cell_back.clear();
    for (auto& part : matter.cell_plastic) part.clear();
    for (MixedCell& mixed : matter.mixed_cell) mixed.flowed = {}, mixed.jump = Vec3::Zero();
    for (ConnectionArrays& along : matter.connection) along.plastic.clear();
    return matter;
}

}  // namespace

double most_per_mass(const std::vector<double>& stiffness, const Aggregate& matter) {
    double most = 0;
    for (std::size_t p = 0; p < stiffness.size(); ++p) {
        most = std::max(most, stiffness[p] / matter.particle_mass[p]);
    }
    return most;
}

double fastest_swing_squared(const Aggregate& of) {
    Aggregate matter = as_molded(of);
    LatticeForces lattice(matter);
    const std::size_t count = matter.particle_count();
    const Vec3Array place = matter.particle_position;
    const std::vector<double>& mass = matter.particle_mass;
    Vec3Array still, pushed, now, before, product;
    lattice.find(matter, Flow::trial, still);
    for (Vec3Array* array : {&now, &before, &product}) set_zero(count, *array);
    for (std::size_t p = 0; p < count; ++p) {
        now.set(p, {noise(3 * p), noise(3 * p + 1), noise(3 * p + 2)});
    }
    double length = std::sqrt(dot(now, now));
    std::vector<double> diagonal, beside;
    while (diagonal.size() < kProducts && length > 0) {
        double most = 0;
        for (std::size_t p = 0; p < count; ++p) {
            most = std::max(most, now.at(p).squaredNorm() / (length * length * mass[p]));
        }
        const double nudge = kNudge * matter.lattice.spacing / std::sqrt(most);
        for_each_particle(count, [&](std::size_t p) {
            now.set(p, now.at(p) / length);
            matter.particle_position.set(p, place.at(p) + nudge / std::sqrt(mass[p]) * now.at(p));
        });
        lattice.find(matter, Flow::trial, pushed);
        for_each_particle(count, [&](std::size_t p) {
            product.set(p, (still.at(p) - pushed.at(p)) / (nudge * std::sqrt(mass[p])));
        });
        diagonal.push_back(dot(now, product));
        const double back = beside.empty() ? 0 : beside.back();
        for_each_particle(count, [&](std::size_t p) {
            product.set(p, product.at(p) - diagonal.back() * now.at(p) - back * before.at(p));
        });
        length = std::sqrt(dot(product, product));
        if (!(length > 1e-6 * std::abs(diagonal.back()))) break;  // all there is
        beside.push_back(length);
        std::swap(before, now), std::swap(now, product);
    }
    const auto rows = static_cast<Eigen::Index>(diagonal.size());
    if (rows == 0) return 0;
    beside.resize(diagonal.size() - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> values;
    values.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), rows),
                                  Eigen::Map<const Eigen::VectorXd>(beside.data(), rows - 1),
                                  Eigen::EigenvaluesOnly);
    return std::max(values.eigenvalues().maxCoeff(), 0.0);
}

SwingBound::SwingBound(const Aggregate& matter, bool parts)
    : found_(kRoom * fastest_swing_squared(matter)) {
    if (parts) {
        found_ = std::max(found_, most_per_mass(stiffness_bound(matter), matter));
    }
    if (!matter.yields()) return;
    const Aggregate molded = as_molded(matter);
    const std::vector<double> bound = LatticeForces(molded).stiffness_bound(molded);
    molded_.assign(bound.begin(), bound.end());
}

void SwingBound::masses_changed(const Aggregate& matter) {
    found_ = std::max(found_, most_per_mass(stiffness_bound(matter), matter));
}

double SwingBound::squared(const Aggregate& matter, const LatticeForces& lattice) const {
    const std::vector<double> bound = lattice.stiffness_bound(matter);
    double stiffer = 1;
    for (std::size_t p = 0; p < molded_.size(); ++p) {
        if (molded_[p] > 0) stiffer = std::max(stiffer, bound[p] / molded_[p]);
    }
    return std::min(most_per_mass(bound, matter), stiffer * found_);
}

}  // namespace swage
