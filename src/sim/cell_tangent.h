// SPDX-License-Identifier: GPL-3.0-or-later
// How the forces of a lattice's cells (laws/cell.h) change with the positions: products of the
// tangent with a direction, exact and without a matrix, and the tangent of coarser cells as small
// dense matrices.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_matrix.h"
#include "sim/cell_sweep.h"
#include "sim/force_slabs.h"
#include "sim/mixed_tangent.h"

namespace swage {

class CellTangent {
  public:
    // `fill`: of each cell, what it carries (CellSweep::carried_fill).
    CellTangent(const Aggregate& matter, const std::vector<float>& fill);

    using Kind = TangentKind;

    // The particles have moved, or flow was committed, since any of these was last asked.
    void moved() { mixed_.forget(); }

    // result = -d(force)/d(position) direction, at the present positions.
    void product(const Aggregate& matter, Kind kind, const Vec3Array& direction, Vec3Array& result);

    // Of each particle, the block of the tangent that is its own.
    std::vector<Mat3> own_blocks(const Aggregate& matter, Kind kind) const;

    // One matrix a cell of the coarse lattice, whose sites are those of every `ratio`-th particle:
    // sum of its cells' tangents, the particles following its corners trilinearly.
    std::vector<CellMatrix> coarse_cells(const Aggregate& matter, Kind kind, const Lattice& coarse,
                                         const Vec3i& ratio) const;

  private:
    struct Law;
    std::vector<Law> laws_for(const Aggregate& matter, Flow flow) const;  // by material

    std::vector<RowSlab> slab_;
    CellPieces pieces_;
    MixedTangent mixed_;       // cells of two materials, beside the sweep
    std::vector<float> fill_;  // these two with room for a batch behind
    std::array<std::vector<float>, 3> at_;
    std::vector<char> whole_;         // of each batch of cells: full, and centred
    std::vector<std::size_t> batch_;  // first one of each piece
};

}  // namespace swage
