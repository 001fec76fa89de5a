// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of the matter (matter/skin_field.h) at the vertices of a skin.
//
// Cells know strain and stress at the centroid of their material, to second order; a vertex lies up
// to a cell beside it. So stress, its components and not what is made of them, and plastic strain
// go through three hands:
//
//     of each cell the line of best fit through it and the cells around, by volume; what is less
//     than full is drawn to that line by what it lacks
//     of each particle the mean of what the cells at it say there, by volume
//     of each vertex the mean of the corners that it follows, by its trilinear weights
//
// A field that is linear in the place comes out exactly, to the surface; across what is one cell
// thick it is constant. Sides never mix: cells are at each other where they share a particle, and a
// cell that a blade or a crack has crossed is of each of its parts alone, and tells of them only
// where no sound cell is at hand. Nor do materials: a vertex tells of the one that it lies in, as
// the boundary in its cell has it. Where a material yields, the stress that a line reaches goes no
// further than to its yield stress, that one nowhere below the least of the cells that its line is
// drawn through, and no plastic strain is below 0. Where a vertex's cell has
// broken its use of strength is 1.
//
// Sources: extrapolation from where elements are right, E. Hinton, J. Campbell, Int. J. Numer.
// Methods Eng. 8, 1974; fits over a patch of them, O. Zienkiewicz, J. Zhu, ibid. 33, 1992.
#pragma once

#include <vector>

#include "matter/skin_field.h"
#include "matter/stress_sample.h"
#include "skin/mount.h"

namespace swage {

// The cells that this asks of, ascending.
std::vector<CellId> cells_under(const Mount& mount, const Aggregate& matter);

// `samples`: of those cells, in their order.
SkinFieldValues skin_fields(const Mount& mount, const Aggregate& matter,
                            const std::vector<StressSample>& samples,
                            const std::vector<SkinField>& fields);

}  // namespace swage
