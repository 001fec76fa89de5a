// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/strength_use.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "laws/cell_back.h"
#include "laws/spring_damper.h"
#include "laws/yield.h"
#include "matter/broken_cells.h"
#include "matter/spring_layout.h"
#include "sim/cell_volume.h"
#include "sim/cracking.h"
#include "sim/flowed_volume.h"
#include "sim/mixed_cells.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 64, kCellsPerChunk = 4096;
// Of a strain measure over the square of what no strain of the cell is beyond, and up to where that
// is so whatever is of higher order (laws/strain_bound.h).
constexpr double kOfMeasure = 3, kSmall = 0.01;
// Equivalent stress over shear modulus and that strain: of a cell sqrt(6), which it is of a
// distortion; of springs, each strained so, the root of 3 times the sum of their shares.
const double kMostOfCells = std::sqrt(6.0), kMostOfSprings = std::sqrt(3 * kAllShares);

// C + I at a corner, and how C_ii there is more than in the middle of its way along another axis.
Symmetric<double> corner_sum(const CornerSums<double>& c, double xi, double eta, double zeta,
                             const CellModuli& law) {
    const double s = 1 / (16 * law.spacing * law.spacing);
    const double thins = (3 * law.bulk - 2 * law.shear) / (3 * law.bulk + 4 * law.shear);
    const auto square = [&](const Triple<double>& along, const Triple<double>& u,
                            const Triple<double>& v, const Triple<double>& uv) {
        const Triple<double> all = along + u + v + uv;
        struct {
            double whole, by_u, by_v;
        } of = {s * dot(all, all), 2 * s * dot(along + v, u + uv), 2 * s * dot(along + u, v + uv)};
        return of;
    };
    const auto x = square(c.x, eta * c.xy, zeta * c.zx, (eta * zeta) * c.xyz);
    const auto y = square(c.y, xi * c.xy, zeta * c.yz, (xi * zeta) * c.xyz);
    const auto z = square(c.z, eta * c.yz, xi * c.zx, (xi * eta) * c.xyz);
    return {
        1 + x.whole - thins * (y.by_u + z.by_v),   1 + y.whole - thins * (x.by_u + z.by_u),
        1 + z.whole - thins * (x.by_v + y.by_v),   s * dot(c.x + zeta * c.zx, c.y + zeta * c.yz),
        s * dot(c.y + xi * c.xy, c.z + xi * c.zx), s * dot(c.z + eta * c.yz, c.x + eta * c.xy)};
}

Vec3 place_of(const Aggregate& matter, CellId cell) {
    const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
    const Vec3 at = matter.cell_centroid[cell].cast<double>() + Vec3::Constant(0.5);
    Vec3 sum = Vec3::Zero();
    for (int c = 0; c < 8; ++c) {
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) weight *= c >> axis & 1 ? at[axis] : 1 - at[axis];
        sum += weight * matter.particle_position.at(corner[c]);
    }
    return sum;
}

// How far it has broken: grows with whatever load breaks of it.
float how_broken(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row) {
    if (!cell_has_broken(matter, cell, row)) return 0;
    float all = 1;
    for (const auto& c : kCellConnection) {
        const std::vector<float>& damage = matter.connection[c.direction].damage;
        if (!damage.empty()) all += damage[corner_particle(row, c.corner)];
    }
    return all;
}

}  // namespace

double spring_stress(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row) {
    const CellSprings<double> springs = springs_of(matter, cell, row);
    return frame_of(springs, kSpringLayout)
        .distortion(springs.strain)
        .stress(lattice_stiffness(matter.material.young_modulus, 1.0));
}

double spring_flow_stress(const Material& of, double alpha) {
    const double shear = lattice_stiffness(of.young_modulus, 1.0);
    return flow_stress({of.yield_stress, of.hardening, shear, flow_curve(of.flow_curve, shear)},
                       alpha)
        .stress;
}

double yield_radius(const CellModuli& law, double alpha) {
    const double shifted = law.back_stress * (1 - portable::exp(-law.back_rate * alpha));
    return mean_flow_stress(law, alpha, 0) - (law.back_stress > 0 ? shifted : 0);
}

StrengthUse::StrengthUse(const Aggregate& matter)
    : law_(material_laws(matter)),
      may_flow_(matter.yields()),
      has_strength_(false),
      springs_(matter.material.mechanics == Mechanics::springs) {
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& of = matter.material_at(m);
        onset_.push_back(breaks_at(of, matter.lattice.spacing) / of.young_modulus);
        first_flow_.push_back(of.yield_stress /
                              (springs_ ? kMostOfSprings * lattice_stiffness(of.young_modulus, 1.0)
                                        : kMostOfCells * law_[m].moduli.shear));
        has_strength_ = has_strength_ || of.breaks();
    }
    remember(matter);
    if (!has_strength_ || !any_damaged(matter)) return;
    broken_.resize(matter.cell_fill.size());
    parallel_each(broken_.size(), kCellsPerChunk, [&](std::size_t c) {
        const auto cell = static_cast<CellId>(c);
        broken_[c] = how_broken(matter, cell, matter.lattice.cell_row(cell));
    });
}

void StrengthUse::remember(const Aggregate& matter) {
    if (!may_flow_ || !matter.has_flowed()) return;
    flowed_.resize(matter.cell_fill.size());
    parallel_each(flowed_.size(), kCellsPerChunk,
                  [&](std::size_t c) { flowed_[c] = matter.hardening_of(static_cast<CellId>(c)); });
}

double StrengthUse::yield_share(const Aggregate& matter, const CellRun& run, int n) const {
    const CellId cell = run.first + n;
    const std::size_t number = matter.material_number(cell);
    if (const MixedCell* const two = matter.mixed_at(cell)) {
        const std::array<double, 2> share = part_yield_shares(matter, law_, *two);
        return std::max(share[0], share[1]);
    }
    if (!matter.material_at(number).yields()) return 0;
    if (springs_) {
        return spring_stress(matter, cell, run.row_at(n)) /
               spring_flow_stress(matter.material, matter.hardening_of(cell));
    }
    const CellModuli& law = law_[number].moduli;
    const CornerSums<double> sums = corner_sums(matter, run, n);
    const CellHistory<double> history = committed_history(matter, cell);
    const Symmetric<double> a = taken_back(history);
    const Columns<double> elastic =
        centroid_gradient(sums, material_place(matter, cell), law.spacing) * a;
    Symmetric<double> z = deviator(cell_strain(elastic).log);
    CellModes<double> q = pulled_back(elastic, sums) - history.modes;
    if (law_[number].kind == CellKind::kinematic && history.alpha > 0) {
        const BackStrain<double> back = committed_back(matter, cell);
        z = z - back.strain, q = q - back.modes;
    }
    const double volume = law.spacing * law.spacing * law.spacing;
    const double fill = matter.cell_fill[cell];
    const double modes =
        mode_flow(fill) * mode_share(fill) * product(mode_stress(law, a, q), q) / volume;
    double square = 6 * law.shear * law.shear * contract(z, z) + 3 * law.shear * modes;
    if (history.alpha == 0 && matter.cell_centroid[cell].norm() < kOffCentre) {
        for (int c = 0; c < 8; ++c) {
            const auto side = [&](int axis) { return c >> axis & 1 ? 1.0 : -1.0; };
            const Symmetric<double> e =
                deviator(strain_of_sum(corner_sum(sums, side(0), side(1), side(2), law)).log);
            square = std::max(square, 6 * law.shear * law.shear * contract(e, e));
        }
    }
    return std::sqrt(square) / yield_radius(law, history.alpha);
}

double StrengthUse::strength_share(const Aggregate& matter, const CellRun& run, int n) const {
    const CellId cell = run.first + n;
    const MixedCell* const two = matter.mixed_at(cell);
    if (two == nullptr) {
        return breaking_strain(matter, run, n, 0) / onset_[matter.material_number(cell)];
    }
    const std::array<double, 2> strain = largest_strains(matter, law_, *two);
    return std::max(strain[0] / onset_[two->material[0]], strain[1] / onset_[two->material[1]]);
}

void StrengthUse::look(const Aggregate& matter, const CellRun& run, std::vector<double>& measure,
                       Most& most) const {
    const bool damaged = any_damaged(matter), has_flowed = matter.has_flowed();
    find_strain_measures(matter, run, measure);
    const auto note = [&](Used& used, double share, CellId cell) {
        if (share > used.share) used = {std::min(share, 1.0), place_of(matter, cell)};
    };
    for (int n = 0; n < run.count; ++n) {
        const CellId cell = run.first + n;
        const bool asks_yield = may_flow_ && most.yield.share < 1;
        const bool asks_strength = has_strength_ && most.strength.share < 1;
        if (!asks_yield && !asks_strength) return;
        const bool flowed = has_flowed && matter.hardening_of(cell) > 0;
        const auto row = run.row_at(n);
        if (asks_strength && damaged &&
            how_broken(matter, cell, row) > (broken_.empty() ? 0 : broken_[cell])) {
            note(most.strength, 1, cell);
        }
        bool may_yield = asks_yield, may_break = asks_strength;
        if (!flowed && measure[n] < kSmall && matter.mixed_at(cell) == nullptr) {
            const std::size_t number = matter.material_number(cell);
            const double strain = std::sqrt(measure[n] / kOfMeasure);
            may_yield = may_yield && strain > most.yield.share * first_flow_[number];
            may_break = may_break && strain > most.strength.share * onset_[number];
        }
        if (!may_yield && !may_break) continue;
        if (may_yield && flowed &&
            matter.hardening_of(cell) > (flowed_.empty() ? 0 : flowed_[cell]))
            note(most.yield, 1, cell);
        if (!cell_is_sound(matter, cell, row)) continue;
        if (may_yield && most.yield.share < 1) note(most.yield, yield_share(matter, run, n), cell);
        if (may_break) note(most.strength, strength_share(matter, run, n), cell);
    }
}

StrengthUse::Most StrengthUse::beyond(const Aggregate& matter, double yield, double strength) {
    Most most{{yield}, {strength}};
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    if ((may_flow_ && yield < 1) || (has_strength_ && strength < 1)) {
        const std::vector<Most> parts =
            parallel_parts(runs.size(), kRunsPerChunk, [&](std::size_t begin, std::size_t end) {
                std::vector<double> measure;
                Most part = most;
                for (std::size_t r = begin; r < end; ++r) look(matter, runs[r], measure, part);
                return part;
            });
        for (const Most& part : parts) {
            if (part.yield.share > most.yield.share) most.yield = part.yield;
            if (part.strength.share > most.strength.share) most.strength = part.strength;
        }
    }
    if (yield < 1) remember(matter);
    if (!(most.yield.share > yield)) most.yield = {};
    if (!(most.strength.share > strength)) most.strength = {};
    return most;
}

Used most_flowed(const Aggregate& matter) {
    Used most;
    CellId where = -1;
    for (CellId cell = 0; cell < static_cast<CellId>(matter.cell_fill.size()); ++cell) {
        const double flowed = matter.hardening_of(cell);
        if (flowed > most.share) most.share = flowed, where = cell;
    }
    if (where >= 0) most.place = place_of(matter, where);
    return most;
}

}  // namespace swage
