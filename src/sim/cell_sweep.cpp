// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_sweep.h"

#include <algorithm>

#include "base/parallel.h"
#include "laws/cell_forces.h"
#include "laws/strain_bound.h"
#include "laws/volume_guard.h"
#include "matter/open_faces.h"
#include "sim/cell_history.h"
#include "sim/flowed_stretch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr ParticleId kZeroAhead = 2048;  // particles whose forces are zeroed at a time
// Cells that share a particle never all move in their stiffest way at once. Of the sum over eight
// cells the fastest motion of a block has, measured for nu = 0 to 0.49, this much of each modulus.
constexpr double kAssembledBulk = 0.47, kAssembledShear = 0.55;
// Over where the guard's own pass is asked, of the volume of a whole cell.
constexpr double kMaybeCrushed = 1e-6;

// Cells this close to yielding are told: the law in lanes and the law alone differ in rounding.
constexpr double kNearYield = 1e-6;  // of the yield stress

// What a kernel is given of a slab.
struct SlabTask {
    const CellConstants* constants = nullptr;
    double crushed = 0;  // det D below which a run is reported
    double strained;     // the same of strain_measure() above; none: 0
    const CellRun *run = nullptr, *run_end = nullptr;
    const std::int32_t* batch = nullptr;  // of the first run
    const float* share;
    const Vec3Array* position;
    const RowSlab* slab = nullptr;
    ForceRows to{};
    ParticleId zeroed = 0;  // the slab's forces are zero up to here
    HistoryRows history;
    std::vector<const CellRun*>*crushed_run = nullptr, *strained_run = nullptr,
                      *yielding_run = nullptr;

    void zero_up_to(ParticleId stop) {
        for (double* component : to.own) std::fill(component + zeroed, component + stop, 0.0);
        zeroed = stop;
    }
};

template <typename V>
SWAGE_INLINE CellShare<V> share_of(const SlabTask& task, std::int32_t shares, int begin) {
    const float* from = task.share + shares + begin % kLanes;
    return {load<V>(from),
            {load<V>(from + kLanes), load<V>(from + 2 * kLanes), load<V>(from + 3 * kLanes)}};
}

template <int kWidth, CellKind kKind>
SWAGE_INLINE void slab_forces(SlabTask& task) {
    typedef LanesOf<kWidth> V;
    typename LaneBatch<kWidth>::Indices lane;
    for (int l = 0; l < kWidth; ++l) lane[l] = l;
    const std::int32_t* batch = task.batch;
    const ParticleId slab_end = task.slab->end;
    const bool watched = task.strained > 0;
    for (const CellRun* run = task.run; run != task.run_end; ++run) {
        const ParticleId reach = std::min(slab_end, run->row[3] + run->count + 1);
        if (reach > task.zeroed) {
            task.zero_up_to(std::min(slab_end, std::max(reach, task.zeroed + kZeroAhead)));
        }
        const CornerRows x = corner_rows(*task.position, *run);
        const CornerForces force = corner_forces(*task.slab, task.to, *run);
        ForceCarry<V> carry;
        V smallest = V{} + task.crushed, strained{};
        V most_over = V{} - task.constants->law.yield_stress;
        bool flowed = false, any_flowed = false;
        for (int begin = 0; begin < run->count; begin += kWidth) {
            const std::int32_t shares = batch[begin / kLanes];
            const int left = run->count - begin, count = left < kWidth ? left : kWidth;
            const CornerSums<V> c = gather<V>(x, begin, count);
            Columns<V> d = {c.x, c.y, c.z};
            if (shares != kWholeCells) d = centroid_sums(c, share_of<V>(task, shares, begin).at);
            V size = dot(d.x, cross(d.y, d.z));
            if (count < kWidth) size = lane < count ? size : smallest;
            smallest = size < smallest ? size : smallest;
            if (watched) {
                V strain = strain_measure(c, task.constants->gram,
                                          shares == kWholeCells ? kInMiddle : kAnywhere);
                if (count < kWidth) strain = lane < count ? strain : V{};
                strained = larger(strained, strain);
            }
            const CellId cell = run->first + begin;
            if (can_flow(kKind) && begin % kLanes == 0) {
                flowed = has_flowed(task.history, cell);
                any_flowed = any_flowed || flowed;
            }
            V over = most_over;
            const CornerSums<V> r = by_share(
                shares != kWholeCells,
                flowed, [&]<bool kPart, bool kFlowed>() __attribute__((always_inline)) {
                    CellShare<V> share{};
                    CellHistory<V> history{};
                    BackStrain<V> back;
                    if constexpr (kPart) share = share_of<V>(task, shares, begin);
                    if constexpr (kFlowed) history = load_history<V>(task.history, cell);
                    if constexpr (kFlowed && kKind == CellKind::kinematic) {
                        back = load_back<V>(task.history, cell);
                    }
                    return cell_forces<kKind, kPart, kFlowed>(*task.constants, c, share, history, 1,
                                                              &over, &back);
                });
            if constexpr (can_flow(kKind)) {
                if (count < kWidth) over = lane < count ? over : most_over;
                most_over = larger(most_over, over);
            }
            add_forces(r, force, begin, count, carry);
        }
        if (run->count % kWidth == 0) add_carried(force, run->count, carry);
        bool crushed = false, yields = false, strains = any_flowed;
        const double near = -kNearYield * task.constants->law.yield_stress;
        for (int l = 0; l < kWidth; ++l) {
            crushed = crushed || smallest[l] < task.crushed;
            yields = yields || most_over[l] > near;
            strains = strains || strained[l] > task.strained;
        }
        if (crushed) task.crushed_run->push_back(run);
        if (can_flow(kKind) && yields) task.yielding_run->push_back(run);
        if (watched && strains) task.strained_run->push_back(run);
        batch += batches_of(*run);
    }
    task.batch = batch;
}

void sweep_slab(CellKind kind, SlabTask& task) {
    by_kind(kind, [&]<CellKind kKind>() {
        by_width([&]<int kWidth>()
                     __attribute__((always_inline)) { slab_forces<kWidth, kKind>(task); });
    });
}

// How stiff a cell may be on a particle of its own [N/m]: by itself, and as one of eight.
struct StiffnessBound {
    double alone = 0, among = 0;
};
// The mean strain's share is bounded by the largest eigenvalue of Hooke's law times that of the
// gradient's Gram matrix, which grows as the centroid leaves the middle; the modes' by the largest
// of the blocks in laws/cell.h. What has flowed is `thin` times as stiff: as its edges are shorter,
// squared, at the most by the greatest eigenvalue of A^2, that by the sums of A's rows.
StiffnessBound stiffness_bound(const CellModuli& law, double fill, const Eigen::Vector3f& centroid,
                               double thin) {
    const double alone = std::max(2 * law.shear, 3 * law.bulk);
    const double among = kAssembledShear * 2 * law.shear + kAssembledBulk * 3 * law.bulk;
    const double modes = 8 * std::max(law.edge + 2 * law.diagonal, 4 * law.diagonal);
    const Vec3 at = 2 * centroid.cast<double>();
    const bool centred = at == Vec3::Zero();
    double gram = 1;  // times 1 / (2 a^2)
    if (!centred) {
        Mat3 g;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            g(i, i) = (1 + at[j] * at[j]) * (1 + at[k] * at[k]);
            g(i, j) = g(j, i) = at[i] * at[j] * (1 + at[k] * at[k]);
        }
        gram = g.cwiseAbs().rowwise().sum().maxCoeff();
    }
    const double mean = 0.5 * fill * law.spacing * gram, own = mode_fill(fill) * modes;
    const auto of = [&](double hooke) {
        return centred ? std::max(mean * hooke, own) : mean * hooke + own;
    };
    return {thin * of(alone), thin * of(among)};
}

template <typename Act>
void for_each_cell(const Aggregate& matter, const Act& act) {
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) act(run, n, run.first + n);
    }
}

}  // namespace

CellSweep::CellSweep(const Aggregate& matter)
    : law_(material_laws(matter)), slab_(cell_slabs(matter)), pieces_(matter, slab_) {
    for (SlabRuns* runs : {&crushed_, &strained_, &yielding_}) runs->resize(slab_.size());
    yields_ = std::any_of(law_.begin(), law_.end(),
                          [](const MaterialLaw& law) { return can_flow(law.kind); });
    cells_changed(matter);
}

void CellSweep::cells_changed(const Aggregate& matter, std::vector<TurnedCell>* turned) {
    const std::vector<float> carried = turned ? fill_ : std::vector<float>();
    fill_ = matter.cell_fill;
    const std::vector<char> whole = whole_cells(matter);
    for_each_cell(matter, [&](const CellRun& run, int n, CellId cell) {
        const bool cracked = !matter.cell_cracked.empty() && matter.cell_cracked[cell] != 0;
        if (whole[cell] && !cracked) return;
        fill_[cell] = 0;
        if (turned && carried[cell] > 0) {
            const MixedCell* two = matter.mixed_at(cell);
            turned->push_back(
                {&run, n,
                 two ? swage::elastic_energy(matter, law_, *two) : energy_of(matter, run, n)});
        }
    });
    mixed_.cells_changed(matter, fill_);
    swept_.clear();
    if (!matter.mixed_cell.empty()) swept_ = fill_;
    for (const MixedCell& mixed : matter.mixed_cell) swept_[mixed.cell] = 0;
    const std::vector<float>& fill = swept();
    batch_.clear();
    share_.clear();
    slab_batch_.clear();
    for (std::size_t slab = 0; slab < slab_.size(); ++slab) {
        slab_batch_.push_back(batch_.size());
        for (const CellRun& run : pieces_.of_slab(matter, slab)) {
            for (int begin = 0; begin < run.count; begin += kLanes) {
                const bool whole = is_whole_batch(matter, fill, run, begin);
                batch_.push_back(whole ? kWholeCells : static_cast<std::int32_t>(share_.size()));
                if (whole) continue;
                const std::size_t at = share_.size();
                share_.resize(at + kCellShares * kLanes, 0.0f);
                for (int n = 0; n < std::min(kLanes, run.count - begin); ++n) {
                    const CellId c = run.first + begin + n;
                    share_[at + n] = fill[c];
                    for (int i = 0; i < 3; ++i) {
                        share_[at + (i + 1) * kLanes + n] = 2 * matter.cell_centroid[c][i];
                    }
                }
            }
        }
    }
}

void CellSweep::forces(const Aggregate& matter, Flow flow, Vec3Array& force) {
    std::vector<MaterialLaw> laws = material_laws(matter, flow);
    std::vector<CellConstants> constants;
    const bool is_plain = flow == Flow::none && matter.cell_history.empty() &&
                          matter.mixed_cell.empty();  // nothing has flowed or will
    for (MaterialLaw& law : laws) {
        if (is_plain && law.kind == CellKind::yielding) law.kind = CellKind::elastic;
        constants.emplace_back(law.moduli);
    }
    force.resize(matter.particle_count());
    SlabTask whole{.strained = strain_measure_at(onset_),
                   .share = share_.data(),
                   .position = &matter.particle_position,
                   .history = HistoryRows(matter)};
    parallel_for(slab_.size(), [&](std::size_t index) {
        RowSlab& slab = slab_[index];
        SlabTask task = whole;
        task.to = force_rows(slab, force);
        task.batch = batch_.data() + slab_batch_[index];
        task.slab = &slab, task.zeroed = slab.begin;
        for (SlabRuns* runs : {&crushed_, &strained_, &yielding_}) (*runs)[index].clear();
        task.crushed_run = &crushed_[index], task.strained_run = &strained_[index];
        task.yielding_run = &yielding_[index];
        const std::span<const CellRun> runs = pieces_.of_slab(matter, index);
        const CellRun* const end = runs.data() + runs.size();
        task.run_end = runs.data();
        while (task.run_end != end) {
            task.run = task.run_end;
            const std::size_t material = matter.material_number(task.run->first);
            do {
                ++task.run_end;
            } while (task.run_end != end &&
                     matter.material_number(task.run_end->first) == material);
            task.constants = &constants[material];
            task.crushed = (guarded_volume(laws[material]) + kMaybeCrushed) * 64 *
                           matter.lattice.cell_volume();
            sweep_slab(laws[material].kind, task);
        }
        task.zero_up_to(slab.end);
    });
    add_seams(slab_, force);
    mixed_.add_forces(matter, laws, force);
}

// NOTE: the sweep does not know how cells of two materials have flowed.
std::vector<const CellRun*> CellSweep::strained_runs(const Aggregate& matter) const {
    std::vector<const CellRun*> runs;
    for (const auto& part : strained_) runs.insert(runs.end(), part.begin(), part.end());
    const std::size_t swept = runs.size();
    const std::vector<CellRun>& all = pieces_.all(matter);
    for (const MixedCell& mixed : matter.mixed_cell) {
        if (fill_[mixed.cell] <= 0 || !(mixed.hardening() > 0)) continue;
        const auto after =
            std::upper_bound(all.begin(), all.end(), mixed.cell,
                             [](CellId cell, const CellRun& run) { return cell < run.first; });
        runs.push_back(&*std::prev(after));
    }
    if (runs.size() > swept) {
        std::sort(runs.begin(), runs.end());
        runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    }
    return runs;
}

// The fewer cells a particle has, the less they hold each other back. Of two materials in a cell
// the bounds add up: the jump between them only softens.
void CellSweep::add_stiffness_bound(const Aggregate& matter, std::vector<double>& bound) const {
    std::vector<double> held_back(bound.size(), 0.0);
    std::vector<char> cells(bound.size(), 0);
    for_each_cell(matter, [&](const CellRun& run, int n, CellId cell) {
        if (fill_[cell] <= 0) return;
        const MixedCell* two = matter.mixed_at(cell);
        StiffnessBound own;
        if (two == nullptr) {
            own =
                stiffness_bound(law_of(matter, cell).moduli, fill_[cell],
                                matter.cell_centroid[cell], thinned(flowed_stretch(matter, cell)));
        }
        for (int m = 0; m < 2 && two != nullptr; ++m) {
            const StiffnessBound part = stiffness_bound(
                law_[two->material[m]].moduli, two->fill[m], two->centroid[m],
                thinned(flowed_stretch([&](int s) { return double(two->flowed[m][s]); })));
            own.alone += part.alone, own.among += part.among;
        }
        for (int c = 0; c < 8; ++c) {
            const ParticleId p = run.corner(n, c);
            bound[p] += own.alone;
            held_back[p] += own.alone - own.among;
            ++cells[p];
        }
    });
    for (std::size_t p = 0; p < bound.size(); ++p) bound[p] -= cells[p] / 8.0 * held_back[p];
}

}  // namespace swage
