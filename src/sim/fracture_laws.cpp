// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/fracture_laws.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace swage {

namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();
// Cosine to a boundary's normal from which on a connection is taken to run through it.
constexpr double kThrough = 0.5;
constexpr double kWatched = 0.8;  // of what a pull along the normal says
}  // namespace

FractureLaws::FractureLaws(const Fracture& one)
    : law_{one}, snaps_at_{one.broken}, least_onset_(one.onset), whole_{0, one.onset <= 0} {}

FractureLaws::FractureLaws(const Aggregate& matter) {
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
    for (std::size_t m = 0; m < law_.size() && hold_any; ++m) {
        breaking_.push_back(breaks(m));
        holding_.push_back(!breaks(m));
    }
    std::array<std::vector<char>, kForwardCount> is_known;
    for (int d = 0; d < kForwardCount; ++d) {
        part_[d].resize(matter.particle_count());
        is_known[d].resize(matter.particle_count(), 0);
    }
    double most = 1;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            const MixedCell* two = matter.mixed_at(cell);
            for (int p = 0; two && p < 2; ++p) {
                if (breaks(two->material[p]))
                    most = std::max(most, 1 / give(*two, two->material[p]));
            }
            for (const auto& [direction, corner] : kCellConnection) {
                const ParticleId lower = run.corner(n, corner);
                const Part own = two ? part_in(*two, direction) : part_in(matter, cell, nullptr);
                Part& part = part_[direction][lower];
                part = std::exchange(is_known[direction][lower], 1) ? both(part, own) : own;
            }
        }
    }
    if (most > 1) watched_ = kWatched / most;
}

FractureLaws::Part FractureLaws::both(Part one, Part other) const {
    const bool other_is_tougher =
        breaks(other.law) && (!breaks(one.law) || law_[other.law].broken > law_[one.law].broken);
    Part both = other_is_tougher ? other : one;
    both.holds = one.holds || other.holds;
    return both;
}

FractureLaws::Part FractureLaws::part_in(const Aggregate& matter, CellId cell,
                                         const MixedCell* two) const {
    const auto of = [&](std::uint8_t material) -> Part { return {material, !breaks(material)}; };
    if (two) return both(of(two->material[0]), of(two->material[1]));
    return matter.cell_material.empty() ? whole_ : of(matter.cell_material[cell]);
}

// Across the boundary, both bearing the same: what the cell is strained by over what one is.
double FractureLaws::give(const MixedCell& two, std::size_t material) const {
    double sum = 0;
    for (int p = 0; p < 2; ++p) sum += two.fill[p] * modulus_[material] / modulus_[two.material[p]];
    return sum / (two.fill[0] + two.fill[1]);
}

FractureLaws::Part FractureLaws::part_in(const MixedCell& two, int direction) const {
    const auto [one, other] = two.material;
    const Part part = both({one, !breaks(one)}, {other, !breaks(other)});
    const Vec3 way = Vec3(kForward[direction][0], kForward[direction][1], kForward[direction][2]);
    const double along = std::abs(way.normalized().dot(two.normal.cast<double>()));
    if (along < kThrough || !breaks(one) || !breaks(other)) return part;
    const std::uint8_t weaker = strength_[one] < strength_[other] ? one : other;
    return {weaker, part.holds, static_cast<float>(give(two, weaker))};
}

const Fracture& FractureLaws::of_cell(const Aggregate& matter, CellId cell) const {
    return law_[matter.inset.empty() ? 0 : part_in(matter, cell, matter.mixed_at(cell)).law];
}

bool FractureLaws::snap_any() const {
    return std::any_of(snaps_at_.begin(), snaps_at_.end(), [](double s) { return s < kNever; });
}

double FractureLaws::snaps_at(int direction, ParticleId lower) const {
    const Part part = part_of(direction, lower);
    return part.holds ? kNever : snaps_at_[part.law];
}

}  // namespace swage
