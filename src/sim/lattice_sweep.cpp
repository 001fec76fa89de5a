// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/lattice_sweep.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "sim/spring_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr ParticleId kZeroAhead = 2048;  // particles whose forces are zeroed at a time

int batches_of(const SpringRun& run) { return (run.count + kLanes - 1) / kLanes; }

// A run's rows: the five that it reads, and where the forces of the four above go.
struct RunRows {
    const double *x[5][3], *v[5][3];
    double* to[5][3];
    int room[5];
    bool above[5];
};

template <bool kDamped>
SWAGE_INLINE RunRows rows_of(const SpringTask& task, const SpringRun& run) {
    RunRows rows;
    for (int q = 0; q < 5; ++q) {
        rows.above[q] = q == 0 || run.above[q - 1] >= 0;
        const ParticleId row = q == 0 || !rows.above[q] ? run.first : run.above[q - 1];
        const bool own = q == 0 || !rows.above[q] || run.met[q - 1] < task.end;
        rows.room[q] = (own ? task.end : task.reach + kSeamRoom) - row;
        for (int i = 0; i < 3; ++i) {
            rows.x[q][i] = task.position[i] + row;
            if constexpr (kDamped) rows.v[q][i] = task.velocity[i] + row;
            rows.to[q][i] = own ? task.to.own[i] + row : task.to.seam[i] + (row - task.end);
        }
    }
    return rows;
}

// At the end of the arrays: what a batch reads beyond them, as far as there is anything.
template <int kWidth>
struct EndCopy {
    double x[2][5][3][kWidth + 2];
    float rest[kForwardCount][kWidth];
};
template <int kWidth, bool kDamped>
[[gnu::noinline]] void copy_end(const SpringTask& task, const SpringRun& run, int begin,
                                EndCopy<kWidth>& copy, SpringPlaces& at) {
    for (int q = 0; q < 5; ++q) {
        const ParticleId row = (q > 0 && run.above[q - 1] >= 0 ? run.above[q - 1] : run.first);
        if (row + begin > 0 && row + begin + kWidth + 1 <= task.particles) continue;
        for (int i = 0; i < 3; ++i) {
            for (int n = 0; n < kWidth + 2; ++n) {
                const int p = std::clamp(row + begin - 1 + n, 0, task.particles - 1);
                copy.x[0][q][i][n] = task.position[i][p];
                if (kDamped) copy.x[1][q][i][n] = task.velocity[i][p];
            }
            at.x[q][i] = copy.x[0][q][i] + 1;
            at.v[q][i] = copy.x[1][q][i] + 1;
        }
    }
    if (run.first + begin + kWidth <= task.particles) return;
    for (int d = 0; d < kForwardCount; ++d) {
        for (int n = 0; n < kWidth; ++n) {
            const int p = std::min(run.first + begin + n, task.particles - 1);
            if (task.flowed) copy.rest[d][n] = task.rest[d][p];
        }
        at.rest[d] = copy.rest[d];
    }
}

template <BatchKind kKind, int kWidth, bool kSprings, bool kDamped, typename V = LanesOf<kWidth>>
SWAGE_INLINE void batch_forces(SpringKernel<kWidth, kSprings, kDamped>& kernel,
                               const SpringPlaces& at, const RunRows& rows, int begin, int count,
                               float* strain, SpringCarry<V>& carry) {
    typedef SpringKernel<kWidth, kSprings, kDamped> Kernel;
    const Triple<V> x = load_triple<V>(at.x[0], 0);
    Triple<V> v{};
    if constexpr (kDamped) v = load_triple<V>(at.v[0], 0);
    Triple<V> own{}, f[3];
    const auto row_of_three = [&]<int d>(int r) __attribute__((always_inline)) {
        kernel.template pull<kKind, d, 2 * d + 1, 2 * d + 2>(at, x, v, strain, f);
        own = own + (f[0] + f[1] + f[2]);
        const Triple<V> given = f[2] + Kernel::template moved<1>(carry.middle[r], f[0]) +
                                Kernel::template moved<2>(carry.forward[r], f[1]);
        carry.middle[r] = f[0], carry.forward[r] = f[1];
        Kernel::take(rows.to[r + 1], begin - 1, rows.room[r + 1], count + 1, given);
    };
    if (rows.above[1]) row_of_three.template operator()<1>(0);
    if (rows.above[2]) row_of_three.template operator()<2>(1);
    kernel.template pull<kKind, 0, 7, 8>(at, x, v, strain, f);
    own = own + (f[0] + f[1] + f[2]) - Kernel::template moved<1>(carry.along, f[0]);
    carry.along = f[0];
    if (rows.above[3]) Kernel::take(rows.to[3], begin, rows.room[3], count, f[1]);
    if (rows.above[4]) Kernel::take(rows.to[4], begin, rows.room[4], count, f[2]);
    Kernel::take(rows.to[0], begin, rows.room[0], count, Triple<V>{-own.x, -own.y, -own.z});
}

// What the last batch, which began at `begin`, has not given yet.
template <typename V>
SWAGE_INLINE void give_carried(const RunRows& rows, int begin, int count, bool goes_on,
                               const SpringCarry<V>& carry) {
    constexpr int kWidth = kWidthOf<V>;
    const auto last = [](const Triple<V>& t, int i, int l) {
        return i == 0 ? t.x[l] : i == 1 ? t.y[l] : t.z[l];
    };
    for (int i = 0; i < 3; ++i) {
        if (goes_on && begin + kWidth == count) {
            rows.to[0][i][count] -= last(carry.along, i, kWidth - 1);
        }
        for (int r = 0; r < 2; ++r) {
            if (!rows.above[r + 1]) continue;
            double* const to = rows.to[r + 1][i];
            const double one =
                last(carry.middle[r], i, kWidth - 1) + last(carry.forward[r], i, kWidth - 2);
            const int end = std::min(count + 1, rows.room[r + 1]);
            if (begin + kWidth - 1 < end) to[begin + kWidth - 1] -= one;
            if (begin + kWidth == count && count < end) {
                to[count] -= last(carry.forward[r], i, kWidth - 1);
            }
        }
    }
}

template <int kWidth, bool kSprings, bool kDamped>
SWAGE_INLINE void slab_forces(SpringTask& task) {
    typedef LanesOf<kWidth> V;
    typename LaneBatch<kWidth>::Indices lane;
    for (int l = 0; l < kWidth; ++l) lane[l] = l;
    static constexpr std::array<float, kLanes> kOnes = {1, 1, 1, 1, 1, 1, 1, 1};
    const std::int32_t* batch = task.batch;
    float* strain = task.strain;
    V work[kLanes / kWidth]{};
    EndCopy<kWidth> copy;
    for (const SpringRun* run = task.run; run != task.run_end; ++run) {
        ParticleId reach = run->first;
        for (ParticleId row : run->above) reach = std::max(reach, row);
        if constexpr (kSprings) {
            const ParticleId stop = std::min(task.end, reach + run->count + 1);
            if (stop > task.zeroed) {
                task.zero_up_to(std::min(task.end, std::max(stop, task.zeroed + kZeroAhead)));
            }
        }
        const RunRows rows = rows_of<kDamped>(task, *run);
        const bool goes_on = run + 1 != task.run_end && run[1].first == run->first + run->count &&
                             run[1].j == run->j && run[1].k == run->k;
        SpringKernel<kWidth, kSprings, kDamped> kernel{task};
        SpringCarry<V> carry;
        int begin = 0;
        for (; begin < run->count; begin += kWidth) {
            const int part = begin / kWidth % (kLanes / kWidth);
            SpringPlaces at;
            for (int q = 0; q < 5; ++q) {
                for (int i = 0; i < 3; ++i) {
                    at.x[q][i] = rows.x[q][i] + begin;
                    if constexpr (kDamped) at.v[q][i] = rows.v[q][i] + begin;
                }
            }
            for (int d = 0; d < kForwardCount; ++d) {
                at.weight[d] =
                    (*batch < 0 ? kOnes.data() : task.weight + *batch + d * kLanes) + part * kWidth;
                if (task.flowed) at.rest[d] = task.rest[d] + run->first + begin;
                if (kDamped && task.grows) at.grown[d] = task.grown[d] + run->first + begin;
            }
            if (reach + begin + kWidth + 1 > task.particles) [[unlikely]] {
                copy_end<kWidth, kDamped>(task, *run, begin, copy, at);
            }
            float* const own = kDamped ? strain + part * kWidth : nullptr;
            kernel.work = work[part];
            kernel.inside = lane < run->count - begin;
            if (task.flowed) {
                batch_forces<BatchKind::flowed>(kernel, at, rows, begin, run->count, own, carry);
            } else if (*batch < 0) {
                batch_forces<BatchKind::plain>(kernel, at, rows, begin, run->count, own, carry);
            } else {
                batch_forces<BatchKind::weighted>(kernel, at, rows, begin, run->count, own, carry);
            }
            work[part] = kernel.work;
            if (part == kLanes / kWidth - 1 || begin + kWidth >= run->count) {
                ++batch;
                strain += kForwardCount * task.branches * kLanes;
            }
        }
        give_carried(rows, begin - kWidth, run->count, goes_on, carry);
        bool stretched = false;
        for (int l = 0; l < kWidth; ++l) {
            stretched = stretched || kernel.most_slack[l] > task.slack_limit;
        }
        if (stretched) task.stretched->push_back(run);
    }
    for (int l = 0; l < kLanes; ++l) task.work[l] = work[l / kWidth][l % kWidth];
}

template <bool kSprings, bool kDamped>
void slab_of(SpringTask& task) {
    by_width([&]<int kWidth>()
                 __attribute__((always_inline)) { slab_forces<kWidth, kSprings, kDamped>(task); });
}

}  // namespace

double lattice_stiffness(const Aggregate& matter) {
    return lattice_stiffness(matter.material.young_modulus, matter.lattice.spacing);
}

LatticeSweep::LatticeSweep(const Aggregate& matter, ConnectionShares shares)
    : shares_(std::move(shares)),
      run_(spring_runs(matter.lattice)),
      slab_(spring_slabs(run_, matter.particle_count())) {
    std::size_t batches = 0;
    for (const RowSlab& slab : slab_) {
        slab_batch_.push_back(batches);
        for (std::size_t r = slab.run_begin; r < slab.run_end; ++r) batches += batches_of(run_[r]);
    }
    batch_.resize(batches);
    stretched_.resize(slab_.size());
    work_.resize(slab_.size());
    connections_changed(matter);
}

void LatticeSweep::connections_changed(const Aggregate& matter, const std::vector<char>& softens) {
    weight_.clear();
    softens_.clear();
    std::int32_t* batch = batch_.data();
    for (const SpringRun& run : run_) {
        for (int begin = 0; begin < run.count; begin += kLanes) {
            const ParticleId first = run.first + begin;
            const int count = std::min(kLanes, run.count - begin);
            float weight[kForwardCount][kLanes] = {};
            bool whole = count == kLanes;
            for (int d = 0; d < kForwardCount; ++d) {
                shares_.copy(matter, d, first, count, weight[d]);
                for (int l = 0; l < kLanes && whole; ++l) whole = weight[d][l] == 1;
            }
            for (int l = 0; l < count && !softens.empty(); ++l) {
                if (!softens[first + l]) continue;
                whole = false;
                softens_.push_back({first + l, static_cast<std::int32_t>(weight_.size() + l)});
            }
            *batch++ = whole ? -1 : static_cast<std::int32_t>(weight_.size());
            if (whole) continue;
            for (const auto& of : weight) weight_.insert(weight_.end(), of, of + kLanes);
        }
    }
    softened_ = softens_.empty() ? std::vector<float>{} : weight_;
    soften(matter);
}

void LatticeSweep::soften(const Aggregate& matter) {
    if (softens_.empty() || matter.connection[0].damage.empty()) return;
    for (const SofteningEnd& end : softens_) {
        for (int d = 0; d < kForwardCount; ++d) {
            const ConnectionArrays& own = matter.connection[d];
            softened_[end.at + d * kLanes] =
                shares_.of(matter, d, end.lower) * (1 - own.damage[end.lower]);
        }
    }
}

double LatticeSweep::sweep(const Aggregate& matter, const Wanted& wanted, Vec3Array& force) {
    const double a = matter.lattice.spacing;
    const Vec3Array &x = matter.particle_position, &v = matter.particle_velocity;
    SpringTask whole;
    whole.particles = static_cast<int>(x.size());
    whole.flowed = wanted.springs && (wanted.rest || !matter.connection[0].plastic.empty());
    for (int i = 0; i < 3; ++i) {
        whole.position[i] = (i == 0 ? x.x : i == 1 ? x.y : x.z).data();
        whole.velocity[i] = (i == 0 ? v.x : i == 1 ? v.y : v.z).data();
    }
    for (int d = 0; d < kForwardCount; ++d) {
        const ConnectionArrays& own = matter.connection[d];
        whole.rest[d] = (wanted.rest ? (*wanted.rest)[d] : own.plastic).data();
    }
    whole.weight = (wanted.springs || !branches_soften() ? weight_ : softened_).data();
    whole.stiffness = lattice_stiffness(matter);
    whole.inverse_square[0] = 1 / (a * a), whole.inverse_square[1] = 0.5 / (a * a);
    whole.slack_limit = slack_at(wanted.limit);
    if (const BranchStep* step = wanted.branches) {
        whole.branches = step->count;
        for (int j = 0; j < step->count; ++j) {
            whole.keep[j] = step->forward[j].keep;
            whole.gain[j] = step->forward[j].gain;
        }
        whole.half_step = 0.5 * step->step;
        for (int kind : {0, 1}) {
            whole.stretch_scale[kind] = step->step * whole.inverse_square[kind];
            whole.turn_scale[kind] = step->step * whole.stretch_scale[kind];
        }
        whole.grows = step->grown != nullptr;
        whole.yield_strain = step->yield_strain;
        for (int d = 0; d < kForwardCount && whole.grows; ++d) {
            whole.grown[d] = (*step->grown)[d].data();
        }
    }
    force.resize(x.size());
    parallel_for(slab_.size(), [&](std::size_t index) {
        RowSlab& slab = slab_[index];
        SpringTask task = whole;
        task.to = force_rows(slab, force);
        task.run = run_.data() + slab.run_begin, task.run_end = run_.data() + slab.run_end;
        task.batch = batch_.data() + slab_batch_[index];
        task.end = slab.end, task.reach = slab.reach, task.zeroed = slab.begin;
        if (wanted.springs) stretched_[index].clear();
        task.stretched = &stretched_[index];
        if (wanted.branches) {
            task.strain = wanted.branches->strain->data() +
                          slab_batch_[index] * kForwardCount * task.branches * kLanes;
        }
        if (!wanted.springs) {
            slab_of<false, true>(task);
        } else {
            wanted.branches ? slab_of<true, true>(task) : slab_of<true, false>(task);
            task.zero_up_to(slab.end);
        }
        double work = 0;
        for (double lane : task.work) work += lane;
        work_[index] = whole.stiffness * a * a * work;
    });
    add_seams(slab_, force);
    double work = 0;
    for (double one : work_) work += one;
    return work;
}

double LatticeSweep::forces(const Aggregate& matter, const RestStrains* rest, Vec3Array& force,
                            const BranchStep* branches, double limit) {
    return sweep(matter, {true, rest, branches, limit}, force);
}

double LatticeSweep::add_branches(const Aggregate& matter, const BranchStep& branches,
                                  Vec3Array& force) {
    return sweep(matter, {false, nullptr, &branches, 1e100}, force);
}

}  // namespace swage
