// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/flowing_cells.h"

#include <algorithm>
#include <cstring>

#include "laws/volume_guard.h"
#include "matter/spring_layout.h"
#include "sim/cell_batch.h"
#include "sim/connection_shares.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

// Of S with c = w and i = 1, which is soon found: below it no cell yields that never has.
constexpr double kUnyielded = 0.25;

// Of numbers in a row, where only `count` may be touched.
template <typename V, typename T>
SWAGE_INLINE V load_some(const T* from, int count) {
    if (count >= kWidthOf<V>) [[likely]]
        return load<V>(from);
    T copy[kWidthOf<V>] = {};
    for (int l = 0; l < count; ++l) copy[l] = from[l];
    return load<V>(copy);
}
template <typename V>
SWAGE_INLINE void store_some(const V& numbers, float* to, int count) {
    const auto stored = __builtin_convertvector(numbers, typename LaneBatch<kWidthOf<V>>::Floats);
    if (count >= kWidthOf<V>) [[likely]] {
        std::memcpy(to, &stored, sizeof stored);
    } else {
        for (int l = 0; l < count; ++l) to[l] = stored[l];
    }
}
template <typename V>
SWAGE_INLINE MaskOf<V> mask_of(const char* flags, int count) {
    MaskOf<V> mask;
    for (int l = 0; l < kWidthOf<V>; ++l) mask[l] = l < count && flags[l] ? -1 : 0;
    return mask;
}

struct FlowTask {
    const FlowSearch& search;
    const CellRun *run, *run_end;
    std::vector<FlowingCells>& found;
};

template <int kWidth>
SWAGE_INLINE void find_in_runs(const FlowTask& task) {
    typedef LanesOf<kWidth> V;
    typedef MaskOf<V> Mask;
    const auto& [matter, law, strain, sound] = task.search;
    const bool fresh = matter.cell_plastic[0].empty();
    const int cells = static_cast<int>(matter.cell_fill.size());
    const Vec3Array& x = matter.particle_position;
    const double* const position[3] = {x.x.data(), x.y.data(), x.z.data()};
    const int particles = static_cast<int>(x.size());
    const double scale = 0.25 / matter.lattice.spacing, least = kUnyielded * yield_distortion(law);
    const double over_length[2] = {1 / reference_length(matter.lattice, 0),
                                   1 / reference_length(matter.lattice, kEdgeCount)};
    Mask lane;
    for (int l = 0; l < kWidth; ++l) lane[l] = l;

    // Cells from `at` on; whether any of them flows.
    CellSprings<V> springs;
    SpringReturn<V> r;
    Mask flows;
    const auto flow_at = [&](const CellRun& run, int at) __attribute__((always_inline)) {
        const CellId cell = run.first + at;
        const int count = std::min(kWidth, run.count - at), cells_left = cells - cell;
        V corner[3][8];
        for (int i = 0; i < 3; ++i) {
            for (int q = 0; q < 4; ++q) {
                const int row = run.row[q] + at, room = particles - row;
                corner[i][2 * q] = load_some<V>(position[i] + row, room);
                corner[i][2 * q + 1] = load_some<V>(position[i] + row + 1, room - 1);
            }
        }
        V distortion{}, shortest = V{} + 1e3, longest = V{} - 1e3;
        const CornerSums<V> sums = sum_corners(corner);
        const V volume = (scale * scale * scale) * dot(sums.x, cross(sums.y, sums.z));
        const V theta =
            log_ratio(smaller(larger(volume, kGuardedVolume + V{}), 1 / kGuardedVolume + V{})) /
            3.0;
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const auto& [direction, low] = kCellConnection[slot];
            const V total = load<V>(strain[direction].data() + run.row[low >> 1] + (low & 1) + at);
            springs.strain[slot] = total;
            if (!fresh) {
                springs.strain[slot] -=
                    load_some<V>(matter.cell_plastic[slot].data() + cell, cells_left);
            }
            const V off = springs.strain[slot] - theta;
            distortion += kSpringLayout.share[slot] * (off * off);
            shortest = smaller(shortest, total), longest = larger(longest, total);
        }
        const V alpha =
            fresh ? V{} : load_some<V>(matter.cell_history.hardening().data() + cell, cells_left);
        Mask far = !(distortion > least);
        if (!fresh) {
            const V most = law.shear_modulus * most_stress(distortion, theta, shortest, longest);
            far = alpha > 0.0 ? most < flow_stress(law, alpha).stress : far;
        }
        if (!is_any((lane < count) & !far)) return false;
        const Mask may = mask_of<V>(sound.data() + cell, count) & !far;
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const auto& [direction, low] = kCellConnection[slot];
            const int high = upper_corner(kCellConnection[slot]);
            const double over = over_length[direction >= kEdgeCount];
            springs.way[slot] = {over * (corner[0][high] - corner[0][low]),
                                 over * (corner[1][high] - corner[1][low]),
                                 over * (corner[2][high] - corner[2][low])};
        }
        flows = return_springs<V>(law, springs, kSpringLayout, theta, alpha, may, r);
        return is_any(flows);
    };
    for (const CellRun* run = task.run; run != task.run_end; ++run) {
        for (int begin = 0; begin < run->count; begin += kLanes) {
            FlowingCells* cells_here = nullptr;
            const int count = std::min(kLanes, run->count - begin);
            for (int part = 0; part < count; part += kWidth) {
                if (!flow_at(*run, begin + part)) continue;
                if (!cells_here) {
                    cells_here = &task.found.emplace_back();
                    cells_here->row = run->row_at(begin);
                    cells_here->first = run->first + begin, cells_here->count = count;
                }
                for (int l = 0; l < kWidth; ++l) cells_here->flows[part + l] = flows[l] != 0;
                std::memcpy(cells_here->d_alpha + part, &r.d_alpha, sizeof r.d_alpha);
                for (int slot = 0; slot < kCellConnectionCount; ++slot) {
                    std::memcpy(cells_here->grows[slot] + part, &r.grows[slot], sizeof(V));
                }
            }
        }
    }
}

struct GrowTask {
    const Aggregate& matter;
    const std::vector<FlowingCells>& flowing;
    RestStrains& rest;
};
template <int kWidth>
SWAGE_INLINE void grow_rest(const GrowTask& task) {
    typedef LanesOf<kWidth> V;
    for (const FlowingCells& cells : task.flowing) {
        MaskOf<V> flows[kLanes / kWidth]{};
        V fill[kLanes / kWidth]{};
        for (int part = 0; part < cells.count; part += kWidth) {
            const int count = cells.count - part;
            flows[part / kWidth] = mask_of<V>(cells.flows.data() + part, count);
            fill[part / kWidth] =
                load_some<V>(task.matter.cell_fill.data() + cells.first + part, count);
        }
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = cells.lower(slot);
            float weight[kLanes];
            task.matter.connection[d].weight.copy(lower, cells.count, weight);
            for (int part = 0; part < cells.count; part += kWidth) {
                const int count = cells.count - part;
                float* const rest = task.rest[d].data() + lower + part;
                const V of = load_some<V>(weight + part, count), old = load_some<V>(rest, count);
                const V share = cell_share(d) * fill[part / kWidth] / of;
                const V grown =
                    (1.0 + old) * power_of_e(share * load<V>(cells.grows[slot] + part)) - 1.0;
                // Severed: its rest length no longer matters.
                store_some<V>(flows[part / kWidth] & (of > 0.0) ? grown : old, rest, count);
            }
        }
    }
}

struct KeepTask {
    Aggregate& matter;
    const std::vector<FlowingCells>& flowing;
    const SpringStrains& strain;
    const RestStrains& rest;
    RestGrowths* growths;
    double* taken;  // kLanes sums
};
template <int kWidth>
SWAGE_INLINE void keep_rest(const KeepTask& task) {
    typedef LanesOf<kWidth> V;
    Aggregate& matter = task.matter;
    V taken[kLanes / kWidth]{};
    for (const FlowingCells& cells : task.flowing) {
        MaskOf<V> flowed[kLanes / kWidth]{};
        for (int part = 0; part < cells.count; part += kWidth) {
            flowed[part / kWidth] = mask_of<V>(cells.flows.data() + part, cells.count - part);
        }
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = cells.lower(slot);
            const double square = d < kEdgeCount ? 1 : 2;  // of its reference length
            float weight[kLanes];
            matter.connection[d].weight.copy(lower, cells.count, weight);
            float* const own = matter.cell_plastic[slot].data() + cells.first;
            for (int part = 0; part < cells.count; part += kWidth) {
                const int count = cells.count - part;
                float* const plastic = matter.connection[d].plastic.data() + lower + part;
                const V old = load_some<V>(plastic, count),
                        now = load_some<V>(task.rest[d].data() + lower + part, count);
                const MaskOf<V>& flows = flowed[part / kWidth];
                const V growth = flows ? now - old : V{};
                const V elastic =
                    power_of_e(load<V>(task.strain[d].data() + lower + part)) - 1.0 - now;
                const V stiffness = square * load_some<V>(weight + part, count);
                taken[part / kWidth] += growth != 0.0 ? stiffness * elastic * growth : V{};
                if (task.growths) {
                    for (int l = 0; l < std::min(kWidth, count); ++l) {
                        if (growth[l] == 0) continue;
                        const double by =
                            weight[part + l] * growth[l] / (1 + now[l] - 0.5 * growth[l]);
                        (*task.growths)[d].push_back({lower + part + l, static_cast<float>(by)});
                    }
                }
                store_some<V>(flows ? now : old, plastic, count);
                const auto grows = __builtin_convertvector(load<V>(cells.grows[slot] + part),
                                                           typename LaneBatch<kWidth>::Floats);
                for (int l = 0; l < std::min(kWidth, count); ++l) own[part + l] += grows[l];
            }
        }
    }
    std::memcpy(task.taken, taken, sizeof taken);
}

}  // namespace

void find_flowing(const FlowSearch& search, const CellRun* run, const CellRun* run_end,
                  std::vector<FlowingCells>& found) {
    const FlowTask task{search, run, run_end, found};
    by_width([&]<int kWidth>() __attribute__((always_inline)) { find_in_runs<kWidth>(task); });
}

void add_flow(const Aggregate& matter, const std::vector<FlowingCells>& flowing,
              RestStrains& rest) {
    const GrowTask task{matter, flowing, rest};
    by_width([&]<int kWidth>() __attribute__((always_inline)) { grow_rest<kWidth>(task); });
}

double keep_flow(Aggregate& matter, const std::vector<FlowingCells>& flowing,
                 const SpringStrains& strain, const RestStrains& rest, RestGrowths* growths) {
    double taken[kLanes], sum = 0;
    const KeepTask task{matter, flowing, strain, rest, growths, taken};
    by_width([&]<int kWidth>() __attribute__((always_inline)) { keep_rest<kWidth>(task); });
    for (double lane : taken) sum += lane;
    std::vector<float>& hardening = matter.cell_history.hardening();
    for (const FlowingCells& cells : flowing) {
        for (int l = 0; l < cells.count; ++l) {
            hardening[cells.first + l] += static_cast<float>(cells.d_alpha[l]);
        }
    }
    return sum;
}

}  // namespace swage
