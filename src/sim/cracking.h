// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells have reached the strength of their material (laws/fracture.h).
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/force_slabs.h"
#include "sim/fracture_laws.h"

namespace swage {

// Sound cells whose largest elastic strain, of their material or of one of their connections, is
// beyond onset and, over that, near the largest of all: those that are next, in the order of the
// cells. What is committed counts; the state should have converged. `only`: runs of cells that are
// looked at; null: all. `carried`: what each sound cell carries, 0: none; null: they are told by
// themselves. Cells beside a crack are spared up to half as much again, and those off its track up
// to twice as much (sim/crack_path.h).
std::vector<CellId> cells_beyond_strength(const Aggregate& matter, const FractureLaws& laws,
                                          const std::vector<const CellRun*>* only,
                                          const std::vector<float>* carried);

// Particles farther from the material of their cell do not tell its strain.
inline constexpr float kOffCentre = 0.15f;  // of the cell

// What is held against onset of a sound cell of one material: its largest elastic strain, of the
// material or, where that has not flowed, of one of its connections. Where it is less than `least`
// it may be told as less.
double breaking_strain(const Aggregate& matter, const CellRun& run, int n, double least);

// Of each cell of a run what strain_bound.h tells apart by, for matter anywhere in it; a few more
// numbers may follow.
void find_strain_measures(const Aggregate& matter, const CellRun& run,
                          std::vector<double>& measure);

// Young's modulus times the strain at which it breaks, or would if it did [Pa]; infinite: never.
double breaks_at(const Material& material, double spacing);

// Runs of cells with connections of these particles, in their order.
std::vector<const CellRun*> cells_beside(
    const Aggregate& matter, const std::vector<std::vector<const SpringRun*>>& particles);

}  // namespace swage
