// SPDX-License-Identifier: GPL-3.0-or-later
// Batches of particles of a row, one a lane, with their nine forward connections: each connection
// is evaluated once. What the three connections to one row above give its particles is brought
// together in registers, so that each row is written once. Everything is inlined into the kernel
// that asks.
//
// Lanes past the end of a run hold what stands in memory behind it; they have no weight.
#pragma once

#include "laws/inverse_root.h"
#include "laws/spring_damper.h"
#include "sim/lane_memory.h"
#include "sim/lattice_sweep.h"

namespace swage {

// What a kernel is given of a slab.
struct SpringTask {
    const SpringRun *run = nullptr, *run_end = nullptr;
    const std::int32_t* batch = nullptr;  // by batches of eight: -1 or where their weights are
    const float* weight = nullptr;
    bool flowed = false;  // rest strains are read
    int particles = 0;
    const double *position[3] = {}, *velocity[3] = {};
    ForceRows to{};
    ParticleId end = 0, reach = 0, zeroed = 0;  // the slab's forces are zero up to `zeroed`
    const float* rest[kForwardCount] = {};
    double stiffness = 0, inverse_square[2] = {};  // of the reference lengths of edge and diagonal
    double slack_limit = 0;                        // beyond, a run is reported
    std::vector<const SpringRun*>* stretched = nullptr;
    // Branches beside the connections.
    int branches = 0;
    double keep[kMostBranches] = {}, gain[kMostBranches] = {};
    double stretch_scale[2] = {};  // step over the square of the reference length
    double half_step = 0;          // [s]
    double turn_scale[2] = {};     // step squared over the square of the reference length
    float* strain = nullptr;       // by batches of eight: direction, branch, lane
    bool grows = false;            // what flowed takes its branches along
    const float* grown[kForwardCount] = {};
    double yield_strain = 0;
    double work[kLanes] = {};  // done on the branches, over stiffness and spacing squared

    void zero_up_to(ParticleId stop) {
        if (stop <= zeroed) return;
        for (double* component : to.own) std::fill(component + zeroed, component + stop, 0.0);
        zeroed = stop;
    }
};

// Where a batch reads: its own row and the four above, by component; and the connections' arrays.
struct SpringPlaces {
    const double *x[5][3], *v[5][3];
    const float *weight[kForwardCount], *rest[kForwardCount], *grown[kForwardCount];
};

// Which row each direction leads to, in the order of SpringPlaces, and its step along x.
inline constexpr int kRowAbove[kForwardCount] = {0, 1, 2, 1, 1, 2, 2, 3, 4};

// What batches hand on: the last forces along the row, and to the rows reached by three directions
// the last of the middle and of the forward one.
template <typename V>
struct SpringCarry {
    Triple<V> along{};
    Triple<V> middle[2]{}, forward[2]{};
};

template <typename V>
SWAGE_INLINE Triple<V> load_triple(const double* const (&from)[3], int skip) {
    return {load<V>(from[0] + skip), load<V>(from[1] + skip), load<V>(from[2] + skip)};
}

enum class BatchKind {
    plain,     // all there, whole, and nothing flowed
    weighted,  // nothing flowed
    flowed,
};

template <int kWidth, bool kSprings, bool kDamped>
struct SpringKernel {
    typedef LanesOf<kWidth> V;
    typedef typename LaneBatch<kWidth>::Indices Indices;

    const SpringTask& task;
    V most_slack{}, work{};
    Indices inside{};  // lanes of the run

    // The forces on the lower ends of three directions' connections, side by side: each one's own
    // steps wait for each other.
    template <BatchKind kKind, int... d>
    SWAGE_INLINE void pull(const SpringPlaces& at, const Triple<V>& x, const Triple<V>& v,
                           float* strain, Triple<V> (&force)[3]) {
        constexpr int direction[3] = {d...};
        const auto kind = [](int n) { return n < kEdgeCount ? 0 : 1; };
        Triple<V> way[3];
        V square[3], y[3], weight[3], pulled[3];
        for (int n = 0; n < 3; ++n) {
            const int c = direction[n];
            way[n] = load_triple<V>(at.x[kRowAbove[c]], kForward[c][0]) - x;
            square[n] = task.inverse_square[kind(c)] * dot(way[n], way[n]);
        }
        inverse_roots(square, y);
        for (int n = 0; n < 3; ++n) {
            const int c = direction[n];
            if constexpr (kKind != BatchKind::plain) {
                weight[n] = load<V>(at.weight[c]);
                weight[n] = inside ? weight[n] : V{};
            }
            if constexpr (kSprings) {
                pulled[n] = kKind == BatchKind::flowed ? spring_slack(y[n], load<V>(at.rest[c]))
                                                       : spring_slack(y[n]);
                V slack = pulled[n];
                if constexpr (kKind != BatchKind::plain) slack = weight[n] > 0.0 ? slack : V{};
                most_slack = larger(most_slack, slack);
            } else {
                pulled[n] = V{};
            }
        }
        if constexpr (kDamped) {
            V stretch[3], before[3]{}, after[3]{};
            for (int n = 0; n < 3; ++n) {
                const int c = direction[n];
                const Triple<V> speed = load_triple<V>(at.v[kRowAbove[c]], kForward[c][0]) - v;
                // (d^2 now less d^2 before the step) / 2 d: what turns is not stretched. Less and
                // less of that where a step goes as far as d, which nears nought.
                const V fast = dot(speed, speed);
                const V steady =
                    larger(1.0 - task.turn_scale[kind(c)] * (fast * (y[n] * y[n])), V{});
                stretch[n] = task.stretch_scale[kind(c)] *
                             ((dot(speed, way[n]) - task.half_step * (fast * steady)) * y[n]);
                if constexpr (kKind != BatchKind::plain) {
                    stretch[n] = weight[n] > 0.0 ? stretch[n] : V{};
                }
            }
            V grown[3]{}, left[3]{};
            for (int n = 0; n < 3 && task.grows; ++n) {
                const int c = direction[n];
                // Strains of branches go by the reference length. What is left is exp(-p / e_y) in
                // small steps.
                grown[n] = load<V>(at.grown[c]) * (square[n] * y[n]);
                if constexpr (kKind != BatchKind::plain) {
                    grown[n] = weight[n] > 0.0 ? grown[n] : V{};
                }
                const V size = larger(grown[n], -grown[n]);
                left[n] = task.yield_strain / (task.yield_strain + size);
            }
            for (int j = 0; j < task.branches; ++j) {
                const double keep = task.keep[j], gain = task.gain[j];
                for (int n = 0; n < 3; ++n) {
                    float* const own = strain + (direction[n] * task.branches + j) * kLanes;
                    const V m = load<V>(own);
                    const V kept = task.grows ? left[n] * (m - gain * grown[n]) : m;
                    const V next = keep * kept + gain * stretch[n];
                    const auto stored =
                        __builtin_convertvector(next, typename LaneBatch<kWidth>::Floats);
                    std::memcpy(own, &stored, sizeof stored);
                    before[n] += m;
                    after[n] += next;
                }
            }
            for (int n = 0; n < 3; ++n) {
                V given =
                    (direction[n] < kEdgeCount ? 0.5 : 1.0) * ((before[n] + after[n]) * stretch[n]);
                if constexpr (kKind != BatchKind::plain) given = weight[n] * given;
                work += given;
                pulled[n] += after[n] * y[n];
            }
        }
        for (int n = 0; n < 3; ++n) {
            V k = task.stiffness * pulled[n];
            if constexpr (kKind != BatchKind::plain) k = weight[n] * k;
            force[n] = k * way[n];
        }
    }

    // Adds -f to the rows of `to`, from lane 0 at `begin`; up to `room` of them may be written over
    // with what they are, `count` are wanted. What lies beyond is another thread's, or nobody's.
    SWAGE_INLINE static void take(double* const (&to)[3], int begin, int room, int count,
                                  const Triple<V>& f) {
        const auto component = [&](double* row, const V& one) __attribute__((always_inline)) {
            double* const from = row + begin;
            if (begin + kWidth <= room) [[likely]] {
                V old;
                std::memcpy(&old, from, sizeof old);
                old -= one;
                std::memcpy(from, &old, sizeof old);
            } else {
                const int end = std::min(count, room) - begin;
                for (int l = 0; l < kWidth && l < end; ++l) from[l] -= one[l];
            }
        };
        component(to[0], f.x);
        component(to[1], f.y);
        component(to[2], f.z);
    }

    // The lanes `by` places further on, the first from the batch before.
    template <int by>
    SWAGE_INLINE static Triple<V> moved(const Triple<V>& before, const Triple<V>& now) {
        Indices shift;
        for (int l = 0; l < kWidth; ++l) shift[l] = l + kWidth - by;
        return {__builtin_shuffle(before.x, now.x, shift),
                __builtin_shuffle(before.y, now.y, shift),
                __builtin_shuffle(before.z, now.z, shift)};
    }
};

}  // namespace swage
