// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/fracture_laws.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swage {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Cosine to a boundary's normal from which on a connection is taken to run through it.
constexpr double kThrough = 0.5;
constexpr double kWatched = 0.8;  // of what a pull along the normal says
// Least s_f / s_1: what softens falls no faster than it rose.
constexpr double kSteepest = 2;

// With its strength lowered, and its toughness kept, to where it is no steeper.
Fracture resolved(const Fracture& law) {
    if (law.broken >= kSteepest * law.peak) return law;
    const double peak = std::sqrt(law.peak * law.broken / kSteepest);
    return {law.onset * (peak / law.peak), peak, kSteepest * peak};
}

// Of what softens together; no steeper than the steepest of it.
struct Joint {
    double stiffness = 0, onset = 0, peak = 0, energy = 0;

    void add(double k, const Fracture& law) {
        stiffness += k;
        onset += k * law.onset;
        peak += k * law.peak;
        energy += k * law.peak * law.broken;
    }
    Fracture law() const { return {onset / stiffness, peak / stiffness, energy / peak}; }
};

}  // namespace

FractureLaws::FractureLaws(const Fracture& one)
    : law_{one}, snaps_at_{one.broken}, least_onset_(one.onset), whole_{0, one.onset <= 0} {}

FractureLaws::FractureLaws(const Aggregate& matter) : whole_{0, false} {
    bool hold_any = false;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& of = matter.material_at(m);
        law_.emplace_back();
        snaps_at_.push_back(kNever);
        strength_.push_back(kNever);
        modulus_.push_back(of.young_modulus);
        hold_any = hold_any || !of.breaks();
        if (!of.breaks()) continue;
        law_.back() =
            fracture_law(of.young_modulus, of.strength, of.toughness, matter.lattice.spacing);
        const double onset = law_.back().onset;
        strength_.back() = onset * of.young_modulus;
        least_onset_ = break_any() ? std::min(least_onset_, onset) : onset;
        // What breaks before it can flow is as brittle as what never flows.
        if (!(of.yield_stress < of.strength)) snaps_at_.back() = law_.back().broken;
    }
    whole_.holds = !breaks(0);
    if (matter.inset.empty() || !break_any()) return;
    for (std::size_t m = 0; m < matter.material_count() && hold_any; ++m) {
        breaking_.push_back(breaks(m));
        holding_.push_back(!breaks(m));
    }
    find_parts(matter);
    double most = 1;
    for (const MixedCell& two : matter.mixed_cell) {
        for (const std::uint8_t m : two.material) {
            if (breaks(m)) most = std::max(most, 1 / give(two, m));
        }
    }
    if (most > 1) watched_ = kWatched / most;
}

template <typename Add>
void FractureLaws::for_parts(const Aggregate& matter, CellId cell, const MixedCell* two,
                             int direction, const Add& add) const {
    if (!two) {
        const std::size_t m = matter.material_number(cell);
        if (breaks(m)) add(m, stiffness_in(matter, cell, nullptr, direction), law_[m], true);
        return;
    }
    const auto [one, other] = two->material;
    const Vec3 way = Vec3(kForward[direction][0], kForward[direction][1], kForward[direction][2]);
    const double along = std::abs(way.normalized().dot(two->normal.cast<double>()));
    if (along >= kThrough && breaks(one) && breaks(other)) {
        const std::size_t weaker = strength_[one] < strength_[other] ? one : other;
        const double k = stiffness_in(matter, cell, two, direction);
        const double fill = double(two->fill[0]) + two->fill[1];
        const double give = fill * modulus_[weaker] / (k * matter.material.young_modulus);
        const Fracture& law = law_[weaker];
        add(weaker, k, resolved({give * law.onset, give * law.peak, law.broken}), false);
        return;
    }
    MaterialMask counts(matter.material_count(), 0);
    for (const std::size_t m : two->material) {
        if (!breaks(m)) continue;
        counts[m] = 1;
        add(m, stiffness_in(matter, cell, two, direction, counts), law_[m], true);
        counts[m] = 0;
    }
}

void FractureLaws::find_parts(const Aggregate& matter) {
    const auto nothing = static_cast<std::uint32_t>(law_.size());
    law_.emplace_back();
    snaps_at_.push_back(kNever);
    for (std::vector<Part>& of : part_) of.assign(matter.particle_count(), {nothing, false});
    // Of what lies in each connection, a cell at a time.
    const auto for_all = [&](const auto& visit) {
        for (const CellRun& run : matter.lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                const MixedCell* two = matter.mixed_at(run.first + n);
                for (const auto& [direction, corner] : kCellConnection) {
                    visit(run.first + n, two, direction, part_[direction][run.corner(n, corner)]);
                }
            }
        }
    };
    for_all([&](CellId cell, const MixedCell* two, int direction, Part& part) {
        const std::size_t own = matter.material_number(cell);
        part.holds |= two ? !breaks(two->material[0]) || !breaks(two->material[1]) : !breaks(own);
        for_parts(matter, cell, two, direction,
                  [&](std::size_t m, double, const Fracture&, bool is_own) {
                      if (part.law > nothing || (is_own && part.law == m)) return;
                      const bool is_first = is_own && part.law == nothing;
                      part.law = static_cast<std::uint32_t>(is_first ? m : law_.size());
                      if (is_first) return;
                      law_.emplace_back();
                      snaps_at_.push_back(0);
                  });
    });
    std::vector<Joint> joint(law_.size() - nothing - 1);
    if (joint.empty()) return;
    for_all([&](CellId cell, const MixedCell* two, int direction, const Part& part) {
        if (part.law <= nothing) return;
        for_parts(matter, cell, two, direction,
                  [&](std::size_t m, double k, const Fracture& law, bool) {
                      joint[part.law - nothing - 1].add(k, law);
                      snaps_at_[part.law] = std::max(snaps_at_[part.law], snaps_at_[m]);
                  });
    });
    for (std::size_t n = 0; n < joint.size(); ++n) {
        const std::size_t at = nothing + 1 + n;
        law_[at] = joint[n].law();
        if (snaps_at_[at] < kNever) snaps_at_[at] = law_[at].broken;
    }
}

// Across the boundary, both bearing the same: what the cell is strained by over what one is.
double FractureLaws::give(const MixedCell& two, std::size_t material) const {
    double sum = 0;
    for (int p = 0; p < 2; ++p) sum += two.fill[p] * modulus_[material] / modulus_[two.material[p]];
    return sum / (two.fill[0] + two.fill[1]);
}

const Fracture& FractureLaws::of_cell(const Aggregate& matter, CellId cell) const {
    const MixedCell* two = matter.mixed_at(cell);
    if (!two) return law_[matter.material_number(cell)];
    const Fracture &one = law_[two->material[0]], &other = law_[two->material[1]];
    return other.broken > one.broken ? other : one;
}

bool FractureLaws::snap_any() const {
    return std::any_of(snaps_at_.begin(), snaps_at_.end(), [](double s) { return s < kNever; });
}

double FractureLaws::snaps_at(int direction, ParticleId lower) const {
    const Part part = part_of(direction, lower);
    return part.holds ? kNever : snaps_at_[part.law];
}

}  // namespace swage
