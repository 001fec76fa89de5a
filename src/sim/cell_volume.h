// SPDX-License-Identifier: GPL-3.0-or-later
// The volumes of lattice cells, by the determinant of their mean deformation gradient.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Cells looked at in one go.
inline constexpr int kCellBlock = 64;

// Volume ratios, 1 at molding, of `count` cells of a run from cell `at` on; count <= kCellBlock.
void cell_volumes(const Aggregate& matter, const CellRun& run, int at, int count, double* volume);

// Mean deformation gradient of cell n of a run.
Mat3 cell_gradient(const Aggregate& matter, const CellRun& run, int n);

// Adds the forces by which crushed cells resist (laws/volume_guard.h), in the order of the cells;
// returns how many of them are inside out.
// Cells that a blade or a crack has crossed have no volume of their own and resist nothing.
int add_guard_forces(const Aggregate& matter, Vec3Array& force);
// The same when these runs are all that have such cells (CellSweep::crushed_runs).
int add_guard_forces(const Aggregate& matter,
                     const std::vector<std::vector<const CellRun*>>& crushed, Vec3Array& force);
// The first cell that is inside out, or -1.
CellId first_inside_out(const Aggregate& matter);
// Keeps only a share of the speed by which cells below half of their volume deform; momentum and
// angular momentum stay. Returns the energy that this takes [J].
double calm_crushed(Aggregate& matter, double keep);
// Adds to each particle what the guard of cells inside out can add to its stiffness [N/m].
void add_guard_stiffness(const Aggregate& matter, std::vector<double>& stiffness);
double guard_energy_of(const Aggregate& matter);  // [J]

// The volume ratio of the most compressed cell that is at least a quarter full; below 0 it is
// turned inside out.
double smallest_cell_volume(const Aggregate& matter);

}  // namespace swage
