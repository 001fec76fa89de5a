// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/lattice_sweep.h"

#include <algorithm>

#include "base/parallel.h"
#include "laws/spring_damper.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr int kBlock = 128;  // connections at a time, so that forces stay in the nearest cache

struct SpanArrays {
    const double *x, *y, *z;     // positions of the lower ends
    const double *ux, *uy, *uz;  // of the upper ends
    const float *weight, *rest;
    double inverse_reference;
    double force_scale;  // stiffness * reference_length
};

// Force on the lower end of `count` connections.
SWAGE_VECTOR_CLONES
void spring_block(const SpanArrays& s, int count, double* __restrict fx, double* __restrict fy,
                  double* __restrict fz) {
    for (int n = 0; n < count; ++n) {
        const double dx = s.ux[n] - s.x[n], dy = s.uy[n] - s.y[n], dz = s.uz[n] - s.z[n];
        const double distance = std::sqrt(dx * dx + dy * dy + dz * dz);
        const double elastic = distance * s.inverse_reference - 1.0 - s.rest[n];
        // Coincident ends have no direction and get no force.
        const double pull = s.force_scale * s.weight[n] * elastic / (distance + 1e-300);
        fx[n] = pull * dx;
        fy[n] = pull * dy;
        fz[n] = pull * dz;
    }
}

// The dashpots' share (S2.4): the part of the relative velocity along the connection; and the
// power [W] that each takes.
SWAGE_VECTOR_CLONES
void dashpot_block(const SpanArrays& s, const SpanArrays& v, double damping, int count,
                   double* __restrict fx, double* __restrict fy, double* __restrict fz,
                   double* __restrict power) {
    for (int n = 0; n < count; ++n) {
        const double dx = s.ux[n] - s.x[n], dy = s.uy[n] - s.y[n], dz = s.uz[n] - s.z[n];
        const double vx = v.ux[n] - v.x[n], vy = v.uy[n] - v.y[n], vz = v.uz[n] - v.z[n];
        const double square = dx * dx + dy * dy + dz * dz;
        const double along = vx * dx + vy * dy + vz * dz;
        const double pull = damping * s.weight[n] * along / (square + 1e-300);
        power[n] = pull * along;
        fx[n] += pull * dx;
        fy[n] += pull * dy;
        fz[n] += pull * dz;
    }
}

SWAGE_VECTOR_CLONES
void add_block(const double* __restrict f, int count, double* __restrict lower) {
    for (int n = 0; n < count; ++n) lower[n] += f[n];
}
SWAGE_VECTOR_CLONES
void subtract_block(const double* __restrict f, int count, double* __restrict upper) {
    for (int n = 0; n < count; ++n) upper[n] -= f[n];
}

SpanArrays arrays_at(const Vec3Array& a, ParticleId lower, ParticleId upper) {
    SpanArrays s{};
    s.x = a.x.data() + lower, s.y = a.y.data() + lower, s.z = a.z.data() + lower;
    s.ux = a.x.data() + upper, s.uy = a.y.data() + upper, s.uz = a.z.data() + upper;
    return s;
}

}  // namespace

LatticeLaw lattice_law(const Aggregate& matter) {
    return {lattice_stiffness(matter.material.young_modulus, matter.lattice.spacing), 0};
}

LatticeSweep::LatticeSweep(const Aggregate& matter) : slab_(span_slabs(matter, part_)) {
    damping_power_.resize(slab_.size());
}

double LatticeSweep::forces(const Aggregate& matter, const LatticeLaw& law, const RestStrains* rest,
                            Vec3Array& force) {
    const std::size_t particles = matter.particle_count();
    parallel_for(slab_.size(), [&](std::size_t index) {
        const SpanSlab& slab = slab_[index];
        ForceSlab& sum = part_[index];
        sum.clear();
        alignas(64) double fx[kBlock], fy[kBlock], fz[kBlock], power[kBlock];
        double damping_power = 0;
        for (std::size_t n = slab.begin; n < slab.end; ++n) {
            const Span& span = matter.lattice.span[n];
            const ConnectionArrays& history = matter.connection[span.direction];
            const double reference = reference_length(matter.lattice, span.direction);
            for (int at = 0; at < span.count; at += kBlock) {
                const int count = std::min(kBlock, span.count - at);
                const ParticleId lower = span.lower + at, upper = span.upper + at;
                SpanArrays s = arrays_at(matter.particle_position, lower, upper);
                s.weight = history.weight.data() + lower;
                s.rest = (rest ? (*rest)[span.direction] : history.plastic).data() + lower;
                s.inverse_reference = 1.0 / reference;
                s.force_scale = law.stiffness * reference;
                spring_block(s, count, fx, fy, fz);
                if (law.damping > 0) {
                    const SpanArrays v = arrays_at(matter.particle_velocity, lower, upper);
                    dashpot_block(s, v, law.damping, count, fx, fy, fz, power);
                    for (int c = 0; c < count; ++c) damping_power += power[c];
                }
                const std::size_t l = lower - sum.begin, u = upper - sum.begin;
                add_block(fx, count, sum.part.x.data() + l);
                add_block(fy, count, sum.part.y.data() + l);
                add_block(fz, count, sum.part.z.data() + l);
                subtract_block(fx, count, sum.part.x.data() + u);
                subtract_block(fy, count, sum.part.y.data() + u);
                subtract_block(fz, count, sum.part.z.data() + u);
            }
        }
        damping_power_[index] = damping_power;
    });
    sum_slabs(part_, particles, force);
    double power = 0;
    for (double one : damping_power_) power += one;
    return power;
}

namespace {

// Calls act(direction, lower, upper, reference_length, distance) for each unsevered connection.
template <typename Act>
void for_each_connection(const Aggregate& matter, const Act& act) {
    for (const Span& span : matter.lattice.span) {
        const std::vector<float>& weight = matter.connection[span.direction].weight;
        const double reference = reference_length(matter.lattice, span.direction);
        for (int n = 0; n < span.count; ++n) {
            if (weight[span.lower + n] <= 0) continue;
            const Vec3 reach = matter.particle_position.at(span.upper + n) -
                               matter.particle_position.at(span.lower + n);
            act(span.direction, span.lower + n, span.upper + n, reference, reach.norm());
        }
    }
}

}  // namespace

double elastic_energy(const Aggregate& matter, const LatticeLaw& law) {
    double sum = 0;
    for_each_connection(
        matter, [&](int d, ParticleId lower, ParticleId, double reference, double distance) {
            const double strain =
                distance / reference - 1 - double(matter.connection[d].plastic[lower]);
            sum += 0.5 * law.stiffness * matter.connection[d].weight[lower] * reference *
                   reference * strain * strain;
        });
    return sum;
}

std::vector<double> stiffness_bound(const Aggregate& matter, const LatticeLaw& law) {
    // A spring's energy k (n.(u1 - u2))^2 / 2 is at most k ((n.u1)^2 + (n.u2)^2): each end may be
    // given the matrix 2 k n n^T of its own. Bounded by the row sums of their sum.
    std::vector<Mat3> block(matter.particle_count(), Mat3::Zero());
    for (const Span& span : matter.lattice.span) {
        const auto& f = kForward[span.direction];
        const Vec3 n = Vec3(f[0], f[1], f[2]).normalized();
        const Mat3 dyad = n * n.transpose();
        const std::vector<float>& weight = matter.connection[span.direction].weight;
        for (int i = 0; i < span.count; ++i) {
            const double k = law.stiffness * weight[span.lower + i];
            block[span.lower + i] += 2 * k * dyad;
            block[span.upper + i] += 2 * k * dyad;
        }
    }
    std::vector<double> bound(block.size());
    for (std::size_t p = 0; p < block.size(); ++p) {
        bound[p] = block[p].cwiseAbs().rowwise().sum().maxCoeff();
    }
    return bound;
}

}  // namespace swage
