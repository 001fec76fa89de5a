// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/internal_damping.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "laws/spring_damper.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr int kBlock = 128;  // connections at a time, so that all of it stays in the nearest cache

struct Block {
    alignas(64) double way[3][kBlock];  // from the lower to the upper end [m], then force [N]
    double distance[kBlock];            // [m]
    double stretched[kBlock];           // in the step, over the length
    double tension[kBlock], lost[kBlock];
};

SWAGE_VECTOR_CLONES
void stretch_ends(const double* const* x, const double* const* v, int skip, int count, double share,
                  Block& block) {
    for (int n = 0; n < count; ++n) {
        const double dx = x[0][n + skip] - x[0][n], dy = x[1][n + skip] - x[1][n],
                     dz = x[2][n + skip] - x[2][n];
        const double along = (v[0][n + skip] - v[0][n]) * dx + (v[1][n + skip] - v[1][n]) * dy +
                             (v[2][n + skip] - v[2][n]) * dz;
        const double distance = std::sqrt(dx * dx + dy * dy + dz * dz) + 1e-300;
        block.way[0][n] = dx, block.way[1][n] = dy, block.way[2][n] = dz;
        block.distance[n] = distance;
        block.stretched[n] = share * along / distance;
        block.tension[n] = block.lost[n] = 0;
    }
}

// share: step over reference length.
void stretch_block(const Vec3Array& x, const Vec3Array& v, ParticleId lower, ParticleId upper,
                   int count, double share, Block& block) {
    const double* const at[3] = {x.x.data() + lower, x.y.data() + lower, x.z.data() + lower};
    const double* const by[3] = {v.x.data() + lower, v.y.data() + lower, v.z.data() + lower};
    stretch_ends(at, by, upper - lower, count, share, block);
}

// What the branch was given by the force that acted during the step, less what it stores now, is
// lost.
SWAGE_VECTOR_CLONES
void branch_block(const DampingStep& forward, double half_inverse, int count,
                  float* __restrict strain, Block& block) {
    for (int n = 0; n < count; ++n) {
        const double before = strain[n];
        strain[n] = static_cast<float>(forward.keep * before + forward.gain * block.stretched[n]);
        const double after = strain[n];
        block.lost[n] +=
            before * block.stretched[n] - half_inverse * (after * after - before * before);
        block.tension[n] += after;
    }
}

// Returns the energy that was lost [J].
SWAGE_VECTOR_CLONES
double force_block(double scale, const float* weight, double length, int count, Block& block) {
    double lost = 0;
    for (int n = 0; n < count; ++n) {
        const double k = scale * double(weight[n]);
        lost += k * length * block.lost[n];
        const double pull = k * block.tension[n] / block.distance[n];
        for (auto& way : block.way) way[n] *= pull;
    }
    return lost;
}

SWAGE_VECTOR_CLONES
void give_block(const double* __restrict f, int count, double* lower, double* upper) {
    for (int n = 0; n < count; ++n) lower[n] += f[n];
    for (int n = 0; n < count; ++n) upper[n] -= f[n];
}

}  // namespace

// A cantilever's first mode: w = 3.516 sqrt(E I / rho A) / L^2, for a square section 1.015 c h /
// L^2.
double slowest_frequency(const Aggregate& matter) {
    const Vec3 size = matter.lattice.spacing * matter.lattice.cell_count.cast<double>();
    const double speed = std::sqrt(matter.material.young_modulus / matter.material.density);
    return speed * size.minCoeff() / (size.maxCoeff() * size.maxCoeff());
}

InternalDamping::InternalDamping(const Aggregate& matter, double highest)
    : branches_(
          damping_branches(matter.material.damping_ratio, slowest_frequency(matter), highest)),
      stiffness_(lattice_stiffness(matter.material.young_modulus, matter.lattice.spacing)) {
    if (!acts()) return;
    for (auto& direction : strain_) {
        for (int j = 0; j < branches_.count; ++j) {
            direction[j].assign(matter.particle_count(), 0.0f);
        }
    }
    slab_ = span_slabs(matter, part_);
    taken_.resize(slab_.size());
}

double InternalDamping::add_forces(const Aggregate& matter, double step, Vec3Array& force) {
    std::array<DampingStep, kMostBranches> forward;
    for (int j = 0; j < branches_.count; ++j) forward[j] = damping_step(branches_, j, step);
    parallel_for(slab_.size(), [&](std::size_t index) {
        ForceSlab& sum = part_[index];
        sum.clear();
        double taken = 0;
        Block block;
        for (std::size_t s = slab_[index].begin; s < slab_[index].end; ++s) {
            const Span& span = matter.lattice.span[s];
            const double length = reference_length(matter.lattice, span.direction);
            for (int at = 0; at < span.count; at += kBlock) {
                const int count = std::min(kBlock, span.count - at);
                const ParticleId lower = span.lower + at, upper = span.upper + at;
                stretch_block(matter.particle_position, matter.particle_velocity, lower, upper,
                              count, step / length, block);
                for (int j = 0; j < branches_.count; ++j) {
                    branch_block(forward[j], 0.5 / branches_.share[j], count,
                                 strain_[span.direction][j].data() + lower, block);
                }
                taken += force_block(stiffness_ * length,
                                     matter.connection[span.direction].weight.data() + lower,
                                     length, count, block);
                const std::size_t l = lower - sum.begin, u = upper - sum.begin;
                for (int axis = 0; axis < 3; ++axis) {
                    std::vector<double>& to = axis == 0   ? sum.part.x
                                              : axis == 1 ? sum.part.y
                                                          : sum.part.z;
                    give_block(block.way[axis], count, to.data() + l, to.data() + u);
                }
            }
        }
        taken_[index] = taken;
    });
    sum_slabs(part_, matter.particle_count(), extra_);
    for (std::size_t p = 0; p < force.size(); ++p) force.add(p, extra_.at(p));
    double taken = 0;
    for (double one : taken_) taken += one;
    return taken;
}

double InternalDamping::stored_energy(const Aggregate& matter) const {
    double sum = 0;
    for (const Span& span : matter.lattice.span) {
        const std::vector<float>& weight = matter.connection[span.direction].weight;
        const double length = reference_length(matter.lattice, span.direction);
        const double k = stiffness_ * length * length;
        for (int j = 0; j < branches_.count; ++j) {
            const std::vector<float>& strain = strain_[span.direction][j];
            for (int n = 0; n < span.count; ++n) {
                const double m = strain[span.lower + n];
                sum += k * double(weight[span.lower + n]) * m * m / (2 * branches_.share[j]);
            }
        }
    }
    return sum;
}

}  // namespace swage
