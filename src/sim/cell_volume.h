// SPDX-License-Identifier: GPL-3.0-or-later
// The volumes of lattice cells, by the determinants of their deformation gradients.
#pragma once

#include <vector>

#include "laws/cell_back.h"
#include "matter/aggregate.h"

namespace swage {

// Cells looked at in one go.
inline constexpr int kCellBlock = 64;

// Volume ratios, 1 at molding, of `count` cells of a run from cell `at` on, at the cells'
// middles; count <= kCellBlock, and volume has room for that many.
void cell_volumes(const Aggregate& matter, const CellRun& run, int at, int count, double* volume);

// Deformation gradient of cell n of a run, at its middle.
Mat3 cell_gradient(const Aggregate& matter, const CellRun& run, int n);

// As the cell's law sees it: from the centroid of its material, -1 to 1 in the cell.
CornerSums<double> corner_sums(const Aggregate& matter, const CellRun& run, int n);
Triple<double> material_place(const Aggregate& matter, CellId cell);
Mat3 material_gradient(const Aggregate& matter, const CellRun& run, int n);
CellHistory<double> committed_history(const Aggregate& matter, CellId cell);
BackStrain<double> committed_back(const Aggregate& matter, CellId cell);
Mat3 matrix_of(const Columns<double>& f);

struct SmallCell {
    const CellRun* run;
    int n;
    double volume;  // ratio, as its law sees it

    CellId id() const { return run->first + n; }
};

// Of a run, or of all: sound cells below a volume ratio, in their order. Cells that a blade or a
// crack has crossed have no volume of their own.
void add_cells_below(const Aggregate& matter, const CellRun& run, double limit,
                     std::vector<SmallCell>& found);
std::vector<SmallCell> cells_below(const Aggregate& matter, double limit);

// The first cell that is inside out, or -1.
CellId first_inside_out(const Aggregate& matter);

// Cells that have cracked, none of whose connections is severed, and that are inside out.
std::size_t cracked_inside_out(const Aggregate& matter);

// What the matter takes up now [m3], as the laws of its cells see it. What is severed or has broken
// has no volume of its own and counts as at molding.
double present_volume(const Aggregate& matter);

// The volume ratio of the most compressed cell that is at least a quarter full; below 0 it is
// turned inside out.
double smallest_cell_volume(const Aggregate& matter);

}  // namespace swage
