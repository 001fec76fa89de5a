// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/fracture_laws.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace swage {

namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();
}

FractureLaws::FractureLaws(const Fracture& one)
    : law_{one}, snaps_at_{one.broken}, least_onset_(one.onset), whole_{0, one.onset <= 0} {}

FractureLaws::FractureLaws(const Aggregate& matter) {
    bool hold_any = false;
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        const Material& of = matter.material_at(m);
        law_.emplace_back();
        snaps_at_.push_back(kNever);
        hold_any = hold_any || !of.breaks();
        if (!of.breaks()) continue;
        law_.back() =
            fracture_law(of.young_modulus, of.strength, of.toughness, matter.lattice.spacing);
        const double onset = law_.back().onset;
        least_onset_ = break_any() ? std::min(least_onset_, onset) : onset;
        if (!std::isfinite(of.yield_stress)) snaps_at_.back() = law_.back().broken;
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
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const Part own = part_in(matter, run.first + n);
            for (const auto& [direction, corner] : kCellConnection) {
                const ParticleId lower = run.row[corner >> 1] + n + (corner & 1);
                Part& part = part_[direction][lower];
                part = std::exchange(is_known[direction][lower], 1) ? both(part, own) : own;
            }
        }
    }
}

FractureLaws::Part FractureLaws::both(Part one, Part other) const {
    const bool other_is_tougher =
        breaks(other.law) && (!breaks(one.law) || law_[other.law].broken > law_[one.law].broken);
    return {other_is_tougher ? other.law : one.law, one.holds || other.holds};
}

FractureLaws::Part FractureLaws::part_in(const Aggregate& matter, CellId cell) const {
    const auto of = [&](std::uint8_t material) -> Part { return {material, !breaks(material)}; };
    if (const MixedCell* two = matter.mixed_at(cell)) {
        return both(of(two->material[0]), of(two->material[1]));
    }
    return matter.cell_material.empty() ? whole_ : of(matter.cell_material[cell]);
}

const Fracture& FractureLaws::of_cell(const Aggregate& matter, CellId cell) const {
    return law_[matter.inset.empty() ? 0 : part_in(matter, cell).law];
}

bool FractureLaws::snap_any() const {
    return std::any_of(snaps_at_.begin(), snaps_at_.end(), [](double s) { return s < kNever; });
}

double FractureLaws::snaps_at(int direction, ParticleId lower) const {
    const Part part = part_of(direction, lower);
    return part.holds ? kNever : snaps_at_[part.law];
}

}  // namespace swage
