// SPDX-License-Identifier: GPL-3.0-or-later
// What cells do that have lost half of their volume (laws/volume_guard.h).
//
// NOTE: the work of flow in such a cell is booked whole, though its own law acts by 1 - b of it.
#pragma once

#include "matter/aggregate.h"
#include "sim/flow.h"

namespace swage {

// Adds the forces by which crushed cells resist, in the order of the cells; returns how many of
// them are inside out.
int add_guard_forces(const Aggregate& matter, Flow flow, Vec3Array& force);
// The same when these runs are all that have such cells (CellSweep::crushed_runs).
int add_guard_forces(const Aggregate& matter, Flow flow,
                     const std::vector<std::vector<const CellRun*>>& crushed, Vec3Array& force);

// What they hold beyond what their laws say [J].
double guard_energy_of(const Aggregate& matter);

// Keeps only a share of the speed by which crushed cells deform; momentum and angular momentum
// stay. Returns the energy that this takes [J].
double calm_crushed(Aggregate& matter, double keep);

// Adds to each particle what cells that are squeezed or inside out can add to its stiffness [N/m].
void add_guard_stiffness(const Aggregate& matter, std::vector<double>& stiffness);

}  // namespace swage
