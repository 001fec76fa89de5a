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
// looked at. `carried`: what each sound cell carries, 0: none; null: they are told by themselves.
// Cells beside a crack are spared up to half as much again, and those off its track up to twice as
// much (sim/crack_path.h).
std::vector<CellId> cells_beyond_strength(const Aggregate& matter, const FractureLaws& laws,
                                          const std::vector<const CellRun*>* only = nullptr,
                                          const std::vector<float>* carried = nullptr);

// Runs of cells with connections of these particles, in their order.
std::vector<const CellRun*> cells_beside(
    const Aggregate& matter, const std::vector<std::vector<const SpringRun*>>& particles);

}  // namespace swage
