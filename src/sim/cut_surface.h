// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a place of a body lies below where it has been cut or broken. The new surface runs half
// a cell before the faces of whole cells that look at cells no longer whole: corners of such faces
// lie half a cell deep, others by their distance to these deeper, and between corners depth is
// interpolated, and goes on before the faces. So it is one continuous function of the place, flat
// where the cut is flat and runs along the lattice, and a mean of its steps elsewhere. Faces of the
// other side, half a cell beyond, do not count: each side's own corners are the nearest.
// All lengths in spacings, all places in cells.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/rest_surface.h"

namespace swage {

class CutSurface {
  public:
    CutSurface(const Lattice& lattice, const std::vector<char>& is_whole);

    // Of a whole cell that is rim: within two and a half spacings.
    RestSurface::Depth at(CellId cell, const Vec3& place) const {
        return interpolate_depth(corner_[slot_[cell]], place);
    }
    bool is_rim(CellId cell) const { return slot_[cell] >= 0; }
    // Cells that have a new face, in their order.
    const std::vector<CellId>& skin() const { return skin_; }

  private:
    std::vector<int> slot_;  // of each cell, -1: no rim
    std::vector<std::array<float, 8>> corner_;
    std::vector<CellId> skin_;
};

}  // namespace swage
