// SPDX-License-Identifier: GPL-3.0-or-later
// What the springs of a whole lattice hold, and how fast they can be.
#include <algorithm>

#include "base/parallel.h"
#include "sim/lane_memory.h"
#include "sim/lattice_sweep.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kSpansPerChunk = 512;
constexpr int kBlock = 64;  // connections

// Consecutive connections of a span: their lower and upper ends, by component.
struct SpanPlaces {
    const double *low[3], *high[3];
    const float *weight, *plastic;  // kBlock of each, in order; no weight behind the last
};

double sum_of(const FewLanes (&sum)[kLanes / kFewLanes]) {
    double all = 0;
    for (int l = 0; l < kLanes; ++l) all += sum[l / kFewLanes][l % kFewLanes];
    return all;
}

// Sum of weight times strain squared.
SWAGE_VECTOR_CLONES
double block_energy(const SpanPlaces& at, int count, int room, double length) {
    FewLanes sum[kLanes / kFewLanes]{};
    for (int n = 0; n < count; n += kFewLanes) {
        double copy[6][kFewLanes];
        FewLanes square{};
        for (int i = 0; i < 3; ++i) {
            const double *low = at.low[i] + n, *high = at.high[i] + n;
            if (n + kFewLanes > room) [[unlikely]] {
                std::fill_n(copy[i], kFewLanes, 0.0), std::fill_n(copy[3 + i], kFewLanes, 0.0);
                std::copy_n(low, count - n, copy[i]);
                std::copy_n(high, count - n, copy[3 + i]);
                low = copy[i], high = copy[3 + i];
            }
            const FewLanes reach = load<FewLanes>(high) - load<FewLanes>(low);
            square += reach * reach;
        }
        const FewLanes strain = root(square) / length - 1.0 - load<FewLanes>(at.plastic + n);
        sum[n % kLanes / kFewLanes] += load<FewLanes>(at.weight + n) * (strain * strain);
    }
    return sum_of(sum);
}

// The branches of a slab.
struct BranchPlaces {
    double inverse_share[kMostBranches] = {};
    int count = 0;
    double scale[kForwardCount] = {};  // energy of a strain of one in a share of one [J]
    const SpringRun *run = nullptr, *run_end = nullptr;
    const std::int32_t* batch = nullptr;
    const float *weight = nullptr, *strain = nullptr;
};

SWAGE_VECTOR_CLONES
double slab_energy(const BranchPlaces& own) {
    const float* strain = own.strain;
    const std::int32_t* batch = own.batch;
    FewLanes sum[kLanes / kFewLanes]{};
    for (const SpringRun* run = own.run; run != own.run_end; ++run) {
        for (int n = 0; n < run->count; n += kLanes, ++batch) {
            for (int d = 0; d < kForwardCount; ++d, strain += own.count * kLanes) {
                for (int part = 0; part < kLanes; part += kFewLanes) {
                    FewLanes square{};
                    for (int j = 0; j < own.count; ++j) {
                        const FewLanes one = load<FewLanes>(strain + j * kLanes + part);
                        square += own.inverse_share[j] * (one * one);
                    }
                    if (*batch >= 0) {
                        square *= load<FewLanes>(own.weight + *batch + d * kLanes + part);
                    }
                    sum[part / kFewLanes] += own.scale[d] * square;
                }
            }
        }
    }
    return sum_of(sum);
}

}  // namespace

double elastic_energy(const Aggregate& matter) {
    const double stiffness = lattice_stiffness(matter);
    const std::vector<Span>& spans = matter.lattice.span;
    const Vec3Array& x = matter.particle_position;
    const int particles = static_cast<int>(x.size());
    return ordered_sum(chunks_of(spans.size(), kSpansPerChunk), [&](std::size_t chunk) {
        const std::size_t end = std::min(spans.size(), (chunk + 1) * kSpansPerChunk);
        double sum = 0;
        float weight[kBlock + kLanes], flowed[kBlock + kLanes] = {};
        for (std::size_t s = chunk * kSpansPerChunk; s < end; ++s) {
            const Span& span = spans[s];
            const ConnectionArrays& all = matter.connection[span.direction];
            const std::vector<float>& plastic = all.plastic;
            const double length = reference_length(matter.lattice, span.direction);
            double own = 0;
            for (int begin = 0; begin < span.count; begin += kBlock) {
                const int count = std::min(kBlock, span.count - begin);
                const ParticleId low = span.lower + begin, high = span.upper + begin;
                for (int n = count / kLanes * kLanes; n < count + kLanes; ++n) weight[n] = 0;
                all.weight.copy(low, count, weight);
                if (!plastic.empty()) std::copy_n(plastic.data() + low, count, flowed);
                const SpanPlaces at{{x.x.data() + low, x.y.data() + low, x.z.data() + low},
                                    {x.x.data() + high, x.y.data() + high, x.z.data() + high},
                                    weight,
                                    flowed};
                own += block_energy(at, count, particles - std::max(low, high), length);
            }
            sum += 0.5 * stiffness * length * length * own;
        }
        return sum;
    });
}

double LatticeSweep::branch_energy(const Aggregate& matter, const DampingBranches& branches,
                                   const std::vector<float>& strain) const {
    BranchPlaces whole{.count = branches.count};
    for (int j = 0; j < branches.count; ++j) whole.inverse_share[j] = 1 / branches.share[j];
    whole.weight = branches_soften() ? softened_.data() : weight_.data();
    for (int d = 0; d < kForwardCount; ++d) {
        const double length = reference_length(matter.lattice, d);
        whole.scale[d] = 0.5 * lattice_stiffness(matter) * length * length;
    }
    const std::size_t each = kForwardCount * kLanes * static_cast<std::size_t>(branches.count);
    return ordered_sum(slab_.size(), [&](std::size_t index) {
        const RowSlab& slab = slab_[index];
        BranchPlaces own = whole;
        own.run = run_.data() + slab.run_begin, own.run_end = run_.data() + slab.run_end;
        own.batch = batch_.data() + slab_batch_[index];
        own.strain = strain.data() + slab_batch_[index] * each;
        return slab_energy(own);
    });
}

std::vector<double> stiffness_bound(const Aggregate& matter, const ConnectionShares& shares) {
    // A spring's energy k (n.(u1 - u2))^2 / 2 is at most k ((n.u1)^2 + (n.u2)^2): each end may be
    // given the matrix 2 k n n^T of its own. Bounded by the row sums of their sum.
    const double stiffness = lattice_stiffness(matter);
    std::vector<Mat3> block(matter.particle_count(), Mat3::Zero());
    for (const Span& span : matter.lattice.span) {
        const auto& f = kForward[span.direction];
        const Vec3 n = Vec3(f[0], f[1], f[2]).normalized();
        const Mat3 dyad = n * n.transpose();
        for (int i = 0; i < span.count; ++i) {
            const double k = stiffness * shares.of(matter, span.direction, span.lower + i);
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
