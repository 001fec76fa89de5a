// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells have reached the strength of their material (laws/fracture.h).
#pragma once

#include <vector>

#include "laws/fracture.h"
#include "matter/aggregate.h"
#include "sim/force_slabs.h"

namespace swage {

// Sound cells whose largest elastic strain, of their mean or of one of their connections, is beyond
// onset and near the largest of all: those that are next, in the order of the cells. What is
// committed counts; the state should have converged. `only`: runs of cells that are looked at.
//
// A cell that has cracked relieves what it is in line with, in motion only as fast as it opens: all
// around the tip would crack until then, a cloud too blunt to go on. What has a cracked cell within
// two in the direction of its pull is therefore spared up to half as much again.
std::vector<CellId> cells_beyond_strength(const Aggregate& matter, const Fracture& law,
                                          const std::vector<const CellRun*>* only = nullptr);

// Runs of cells with connections of these particles, in their order.
std::vector<const CellRun*> cells_beside(
    const Aggregate& matter, const std::vector<std::vector<const SpringRun*>>& particles);

}  // namespace swage
