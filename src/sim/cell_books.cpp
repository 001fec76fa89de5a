// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweep over cells does for the ledger: the energy they hold and the flow they commit,
// eight cells of a row at a time. Each cell's numbers are added in the order of the cells.

#include "base/parallel.h"
#include "laws/back_growth.h"
#include "laws/cell_forces.h"
#include "laws/cell_growth.h"
#include "laws/cell_rest.h"
#include "sim/cell_history.h"
#include "sim/cell_sweep.h"
#include "sim/cell_volume.h"
#include "sim/connection_shares.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

// What is asked of a run.
struct BookTask {
    const Aggregate* matter;
    HistoryRows history;
    const MaterialLaw* law = nullptr;
    const CellRun* run = nullptr;
    const std::int32_t* batch = nullptr;  // of the run: kWholeCells, or where its shares begin
    const float* share;
    Aggregate* flows = nullptr;      // whose history grows
    RestGrowths* growths = nullptr;  // where that of its rest lengths goes; null: nowhere
    double sum = 0;                  // [J]; commit with nowhere to put the flow: cells that flow
};

template <typename V>
struct BookCells {
    CornerSums<V> sums;
    Columns<V> gradient;     // F
    CellHistory<V> history;  // all zero where nothing has flowed
    CellStrain<V> strain;
    CellModes<V> modes;  // F_e^T Q
    V fill;
    Triple<V> at;  // the material's centroid
};

template <typename V>
SWAGE_INLINE BookCells<V> load_cells(const BookTask& task, int begin, int count) {
    const Aggregate& matter = *task.matter;
    BookCells<V> r{};
    r.sums = gather<V>(corner_rows(matter.particle_position, *task.run), begin, count);
    const std::int32_t shares = task.batch[begin / kLanes];
    if (shares == kWholeCells) {
        r.fill = V{} + 1.0;
    } else {
        const float* from = task.share + shares + begin % kLanes;
        r.fill = load<V>(from);
        r.at = {load<V>(from + kLanes), load<V>(from + 2 * kLanes), load<V>(from + 3 * kLanes)};
    }
    r.gradient = centroid_gradient(r.sums, r.at, matter.lattice.spacing);
    const CellId first = task.run->first + begin;
    Columns<V> elastic = r.gradient;
    if (has_flowed(task.history, first - begin % kLanes)) {
        r.history = load_history<V>(task.history, first);
        elastic = elastic * taken_back(r.history);
    }
    r.strain = cell_strain(elastic);
    r.modes = pulled_back(elastic, r.sums);
    return r;
}

template <int kWidth>
SWAGE_INLINE void add_energy(BookTask& task) {
    typedef LanesOf<kWidth> V;
    const double volume = task.matter->lattice.cell_volume();
    const auto& [law, kind] = *task.law;
    for (int begin = 0; begin < task.run->count; begin += kWidth) {
        const int count = std::min(kWidth, task.run->count - begin);
        const BookCells<V> c = load_cells<V>(task, begin, count);
        const CellModes<V> q = c.modes - c.history.modes;
        const V modes =
            0.5 * mode_fill(c.fill) * product(mode_stress(law, taken_back(c.history), q), q);
        const V mean = mean_energy(kind, law, c.gradient, c.strain);
        const V energy = volume * c.fill * mean + modes;
        for (int l = 0; l < count; ++l) {
            if (c.fill[l] > 0) task.sum += energy[l];
        }
    }
}

template <typename V>
SWAGE_INLINE void keep(const V& value, const V& flows, int count, float* to) {
    for (int l = 0; l < count; ++l) {
        if (flows[l] > 0) to[l] = static_cast<float>(value[l]);
    }
}

// Of cells whose history comes to be this.
template <typename V>
SWAGE_INLINE void add_growths(const BookTask& task, int begin, int count, const BookCells<V>& c,
                              const CellHistory<V>& after, const V& flows) {
    const Lattice& lattice = task.matter->lattice;
    const CellRest<V> was = cell_rest(c.history, c.at, lattice.spacing),
                      is = cell_rest(after, c.at, lattice.spacing);
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& connection = kCellConnection[slot];
        const int d = connection.direction, high = upper_corner(connection);
        // They grow by little in a step.
        const V now = rest_square(is, connection.corner, high),
                old = rest_square(was, connection.corner, high);
        const V by = cell_share(d) * c.fill * (now - old) / (now + old);
        const ParticleId lower =
            task.run->row[connection.corner >> 1] + (connection.corner & 1) + begin;
        for (int l = 0; l < count; ++l) {
            if (flows[l] > 0) (*task.growths)[d].push_back({lower + l, static_cast<float>(by[l])});
        }
    }
}

template <CellKind kKind, int kWidth>
SWAGE_INLINE void add_flow(BookTask& task) {
    typedef LanesOf<kWidth> V;
    constexpr bool kShifts = kKind == CellKind::kinematic;
    const double volume = task.matter->lattice.cell_volume();
    const CellModuli& law = task.law->moduli;
    for (int begin = 0; begin < task.run->count; begin += kWidth) {
        const int count = std::min(kWidth, task.run->count - begin);
        const BookCells<V> c = load_cells<V>(task, begin, count);
        const CellId first = task.run->first + begin;
        BackStrain<V> back{};
        const auto r = [&]() __attribute__((always_inline)) {
            if constexpr (kShifts) {
                if (has_flowed(task.history, first - begin % kLanes)) {
                    back = load_back<V>(task.history, first);
                }
                return flow_with_back(law, c.history, back, c.strain.log, c.modes, c.fill);
            } else {
                return flow_cell(law, c.history, c.strain.log, c.modes, c.fill);
            }
        }
        ();
        V flows{};
        bool any = false;
        for (int l = 0; l < count; ++l) {
            const bool does = c.fill[l] > 0 && (r.d_alpha[l] > 0 || r.alone.d_alpha[l] > 0);
            flows[l] = does;
            any = any || does;
        }
        if (!any) continue;
        if (task.flows == nullptr) {
            for (int l = 0; l < count; ++l) task.sum += flows[l];
            continue;
        }
        // The stress that did the flow's work is the one after the return, less what hardening
        // stores: hardening is booked as lost, and what the back stress stores too, until flow back
        // takes it from there.
        const V part = volume * c.fill;
        for (int l = 0; l < count; ++l) {
            if (!(flows[l] > 0)) continue;
            double stress = mean_flow_stress(law, c.history.alpha[l], r.d_alpha[l]);
            if constexpr (kShifts) stress += r.more[l];
            task.sum += part[l] * (r.d_alpha[l] * stress + r.alone.took[l]);
        }
        CellHistory<V> after;
        if constexpr (kShifts) {
            const BackGrown<V> grown = flowed_on(c.history, back, r, c.gradient, c.sums);
            after = grown.history;
            for_each_number(
                grown.back.strain,
                grown.back.modes, [&](int n, const V& number) __attribute__((always_inline)) {
                    keep(number, flows, count, task.flows->cell_back.row[n].data() + first);
                });
        } else {
            after = flowed_on(c.history, r, c.gradient, c.sums);
        }
        if (task.growths) add_growths(task, begin, count, c, after, flows);
        for_each_number(
            after, [&](int n, const V& number) __attribute__((always_inline)) {
                keep(number, flows, count, task.flows->cell_history.row[n].data() + first);
            });
    }
}

}  // namespace

// The sum over slabs of act(task, slab) for each of the runs that `of` has, or else for all.
template <typename Act>
double CellSweep::sum_of_runs(const Aggregate& matter, const SlabRuns* of, const Act& act) const {
    return ordered_sum(slab_.size(), [&](std::size_t s) {
        BookTask task{.matter = &matter, .history = HistoryRows(matter), .share = share_.data()};
        const std::int32_t* batch = batch_.data() + slab_batch_[s];
        std::size_t next = 0;
        for (const CellRun& run : pieces_.of_slab(matter, s)) {
            task.run = &run;
            task.batch = batch;
            // What other slabs' cells have flowed is theirs to change meanwhile.
            task.history.cells = run.first + run.count;
            batch += batches_of(run);
            if (of != nullptr) {
                if (next == (*of)[s].size()) break;
                if ((*of)[s][next] != &run) continue;
                ++next;
            }
            task.law = &law_of(matter, run.first);
            act(task, s);
        }
        return task.sum;
    });
}

double CellSweep::commit(Aggregate& matter, Forces found, SlabGrowths* growths) const {
    if (!yields_) return mixed_.commit(matter, law_, found, nullptr);
    if (growths) growths->resize(slab_.size() + 1);
    const SlabRuns* const of = found == Forces::fresh ? &yielding_ : nullptr;
    RestGrowths* const mixed_growths = growths ? &growths->back() : nullptr;
    const auto sum = [&](Aggregate* flows) {
        return sum_of_runs(matter, of, [&](BookTask& task, std::size_t slab) {
            const CellKind kind = task.law->kind;
            if (!can_flow(kind)) return;
            task.flows = flows;
            if (growths) task.growths = &(*growths)[slab];
            by_width([&]<int kWidth>() __attribute__((always_inline)) {
                kind == CellKind::kinematic ? add_flow<CellKind::kinematic, kWidth>(task)
                                            : add_flow<CellKind::yielding, kWidth>(task);
            });
        });
    };
    if (matter.cell_history.empty()) {
        if (sum(nullptr) == 0) return mixed_.commit(matter, law_, found, mixed_growths);
        matter.cell_history.assign(fill_.size());
    }
    const bool shifts = std::any_of(law_.begin(), law_.end(), [](const MaterialLaw& law) {
        return law.kind == CellKind::kinematic;
    });
    if (shifts && matter.cell_back.empty()) matter.cell_back.assign(fill_.size());
    const double lost = sum(&matter);
    return lost + mixed_.commit(matter, law_, found, mixed_growths);
}

double CellSweep::energy_of(const Aggregate& matter, const CellRun& run, int n) const {
    const CellId cell = run.first + n;
    const double a = matter.lattice.spacing, fill = matter.cell_fill[cell];
    const auto& [law, kind] = law_of(matter, cell);
    const CellHistory<double> history = committed_history(matter, cell);
    const CornerSums<double> sums = corner_sums(matter, run, n);
    const Columns<double> f = centroid_gradient(sums, material_place(matter, cell), a);
    const Columns<double> elastic = f * taken_back(history);
    const CellModes<double> q = pulled_back(elastic, sums) - history.modes;
    const double mean = mean_energy(kind, law, f, cell_strain(elastic));
    return a * a * a * fill * mean +
           0.5 * mode_fill(fill) * product(mode_stress(law, taken_back(history), q), q);
}

double CellSweep::elastic_energy(const Aggregate& matter) const {
    const double swept = sum_of_runs(matter, nullptr, [&](BookTask& task, std::size_t) {
        by_width([&]<int kWidth>() __attribute__((always_inline)) { add_energy<kWidth>(task); });
    });
    return swept + mixed_.elastic_energy(matter, law_);
}

}  // namespace swage
