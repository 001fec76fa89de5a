// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/mixed_cells.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "base/principal_axes.h"
#include "laws/cell_growth.h"
#include "sim/cell_volume.h"
#include "sim/connection_shares.h"
#include "sim/mixed_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kBatchesPerChunk = 8, kCellsPerChunk = 64;
constexpr double kNearYield = 1e-6;  // of the yield stress: lanes round otherwise

// Eight cells, as so many batches of the machine's own width. `push`: on their corners, by
// component and corner.
template <int kWidth>
SWAGE_INLINE void batch_forces(const MixedBatch& batch, std::array<double, 24>* push,
                               MixedCells::Seen* seen) {
    typedef LanesOf<kWidth> V;
    const double spacing = batch.matter.lattice.spacing;
    for (int begin = 0; begin < batch.count(); begin += kWidth) {
        const MixedLanes<kWidth> cells(batch, begin);
        Laminate<V> found;
        laminate(cells.sums, cells.phase, cells.normal, spacing, found, cells.jump);
        const Triple<V> jump = jump_in_cell(found);
        V force[3][8];
        spread_corners(laminate_forces(cells.sums, cells.phase, found, spacing), force);
        for (int l = 0; l < kWidth && begin + l < batch.count(); ++l) {
            for (int n = 0; n < 24; ++n) push[begin + l][n] = force[n / 8][n % 8][l];
            MixedCells::Seen& own = seen[begin + l];
            own = {false, {jump.x[l], jump.y[l], jump.z[l]}};
            for (int p = 0; p < 2; ++p) {
                const double near = -kNearYield * cells.phase[p].law->yield_stress;
                const auto& flowed = found.phase[p].flowed;
                own.may_flow = own.may_flow || (cells.phase[p].kind == CellKind::yielding &&
                                                larger(flowed.over, flowed.alone.over)[l] > near);
            }
        }
    }
}

// One cell as plain numbers.
struct OneMixed {
    Phase<double> phase[2]{};
    CornerSums<double> sums;
    Laminate<double> found;
};
// `seen`: of the forces just found there, which have ended where this is to begin.
OneMixed one_mixed(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                   const MixedCell& cell, const MixedCells::Seen* seen = nullptr) {
    OneMixed one;
    double at[3][8];
    Triple<double> normal, start;
    for (int p = 0; p < 2; ++p) {
        one.phase[p].law = &laws[cell.material[p]].moduli;
        one.phase[p].kind = laws[cell.material[p]].kind;
    }
    read_mixed(matter.particle_position, cell, matter.lattice.cell_corners(cell.cell), 0, at,
               one.phase, normal, start);
    one.sums = sum_corners(at);
    if (seen != nullptr) start = {seen->jump.x(), seen->jump.y(), seen->jump.z()};
    laminate(one.sums, one.phase, normal, matter.lattice.spacing, one.found, start);
    return one;
}

// What has not flowed remembers nothing; what is flat has no axes to remember it by.
void remember(const Vec3& jump, MixedCell& cell) {
    cell.jump = cell.hardening() > 0 && jump.allFinite() ? jump : Vec3::Zero();
}

// Of one of the two materials, with its part in the jump.
Columns<double> gradient_of(const OneMixed& one, const MixedCell& cell, int p) {
    double share[2];
    jump_shares(one.phase, share);
    const Triple<double> normal = {cell.normal.x(), cell.normal.y(), cell.normal.z()};
    return jumped(one.found.phase[p].gradient, normal, share[p] * one.found.jump);
}

double energy_in(const Aggregate& matter, const MixedCell& cell, const OneMixed& one) {
    const double volume = matter.lattice.cell_volume();
    double sum = 0;
    for (int p = 0; p < 2; ++p) {
        const Phase<double>& m = one.phase[p];
        const PhaseState<double>& s = one.found.phase[p];
        const Columns<double> f = gradient_of(one, cell, p);
        const Symmetric<double> a = taken_back(m.history);
        const double mean = mean_energy(m.kind, *m.law, f, cell_strain(f * a)) +
                            layer_guard(m, f, s.gradient).energy;
        const CellModes<double> q = s.modes - m.history.modes;
        sum += volume * m.fill * mean +
               0.5 * mode_fill(m.fill) * product(mode_stress(*m.law, a, q), q);
    }
    return sum;
}

}  // namespace

double elastic_energy(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                      const MixedCell& cell) {
    return energy_in(matter, cell, one_mixed(matter, laws, cell));
}

std::array<double, 2> largest_strains(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                                      const MixedCell& cell) {
    const OneMixed one = one_mixed(matter, laws, cell);
    std::array<double, 2> largest;
    for (int p = 0; p < 2; ++p) {
        const Columns<double> f = gradient_of(one, cell, p) * taken_back(one.phase[p].history);
        Mat3 g;
        g << f.x.x, f.y.x, f.z.x, f.x.y, f.y.y, f.z.y, f.x.z, f.y.z, f.z.z;
        largest[p] = std::sqrt(principal_values(g.transpose() * g)[2]) - 1;
    }
    return largest;
}

std::array<double, 2> part_yield_shares(const Aggregate& matter,
                                        const std::vector<MaterialLaw>& laws,
                                        const MixedCell& cell) {
    const OneMixed one = one_mixed(matter, laws, cell);
    std::array<double, 2> share{};
    for (int p = 0; p < 2; ++p) {
        const Phase<double>& phase = one.phase[p];
        if (phase.kind != CellKind::yielding) continue;
        const CellFlowed<double>& r = one.found.phase[p].flowed;
        const double alpha = phase.history.alpha;
        share[p] = (r.over + r.line.stress + r.line.slope * alpha) /
                   mean_flow_stress(*phase.law, alpha, 0);
    }
    return share;
}

std::array<PartStress, 2> part_stresses(const Aggregate& matter,
                                        const std::vector<MaterialLaw>& laws,
                                        const MixedCell& cell) {
    const OneMixed one = one_mixed(matter, laws, cell);
    std::array<PartStress, 2> part;
    for (int p = 0; p < 2; ++p) {
        part[p] = {matrix_of(gradient_of(one, cell, p)), matrix_of(one.found.phase[p].stress)};
    }
    return part;
}

MixedBatches::MixedBatches(const Aggregate& matter, const std::vector<float>& carried) {
    for (std::size_t n = 0; n < matter.mixed_cell.size(); ++n) {
        const MixedCell& mixed = matter.mixed_cell[n];
        if (carried[mixed.cell] <= 0) continue;
        const bool same =
            !cell.empty() && matter.mixed_cell[cell.back()].material == mixed.material;
        const int at = static_cast<int>(cell.size());
        if (!same || at - first.back() == kLanes) first.push_back(at);
        cell.push_back(static_cast<int>(n));
        corner.push_back(matter.lattice.cell_corners(mixed.cell));
    }
    first.push_back(static_cast<int>(cell.size()));
}

void MixedCells::cells_changed(const Aggregate& matter, const std::vector<float>& carried) {
    batches_ = {matter, carried};
    push_.resize(batches_.cell.size());
    seen_.assign(batches_.cell.size(), {});
}

void MixedCells::add_forces(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                            Vec3Array& force) {
    if (batches_.cell.empty()) return;
    parallel_each(batches_.count(), kBatchesPerChunk, [&](std::size_t b) {
        const MixedBatch batch = mixed_batch(matter, laws, batches_, b);
        const int first = batches_.first[b];
        by_width([&]<int kWidth>() __attribute__((always_inline)) {
            batch_forces<kWidth>(batch, &push_[first], &seen_[first]);
        });
    });
    for (std::size_t n = 0; n < batches_.cell.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            force.add(batches_.corner[n][c], {push_[n][c], push_[n][8 + c], push_[n][16 + c]});
        }
    }
}

double MixedCells::commit(Aggregate& matter, const std::vector<MaterialLaw>& laws, Forces found,
                          RestGrowths* growths) const {
    const double volume = matter.lattice.cell_volume();
    double lost = 0;
    for (std::size_t n = 0; n < batches_.cell.size(); ++n) {
        MixedCell& cell = matter.mixed_cell[batches_.cell[n]];
        const Seen* const seen = found == Forces::fresh ? &seen_[n] : nullptr;
        if (seen && !seen->may_flow) {
            remember(seen->jump, cell);
            continue;
        }
        const OneMixed one = one_mixed(matter, laws, cell, seen);
        const Triple<double> jump = jump_in_cell(one.found);
        SlotLengths was;
        if (growths) was = rest_lengths(matter, cell.cell, &cell);
        for (int p = 0; p < 2; ++p) {
            const CellFlowed<double>& r = one.found.phase[p].flowed;
            if (one.phase[p].kind != CellKind::yielding || !(r.whole_d_alpha() > 0)) continue;
            const CellModuli& law = *one.phase[p].law;
            const double stress = mean_flow_stress(law, one.phase[p].history.alpha, r.d_alpha);
            lost += volume * one.phase[p].fill * (r.d_alpha * stress + r.alone.took);
            const CellHistory<double> after =
                flowed_on(one.phase[p].history, r, one.found.phase[p].gradient, one.sums);
            for_each_number(after, [&](int s, const double& now) {
                cell.flowed[p][s] = static_cast<float>(now);
            });
        }
        remember({jump.x, jump.y, jump.z}, cell);
        if (growths == nullptr) continue;
        const SlotLengths is = rest_lengths(matter, cell.cell, &cell);
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const CellConnection& c = kCellConnection[slot];
            const double by = portable::log(is[slot] / was[slot]) * cell_share(c.direction) *
                              matter.cell_fill[cell.cell];
            (*growths)[c.direction].push_back(
                {batches_.corner[n][c.corner], static_cast<float>(by)});
        }
    }
    return lost;
}

double MixedCells::elastic_energy(const Aggregate& matter,
                                  const std::vector<MaterialLaw>& laws) const {
    return ordered_sum_of(batches_.cell.size(), kCellsPerChunk, [&](std::size_t n) {
        const MixedCell& cell = matter.mixed_cell[batches_.cell[n]];
        return energy_in(matter, cell, one_mixed(matter, laws, cell));
    });
}

}  // namespace swage
