// SPDX-License-Identifier: GPL-3.0-or-later
// What of an inset lies within the body, of cells that the surfaces of both run through.
#pragma once

#include "geometry/triangle_tree.h"
#include "mold/shares.h"

namespace swage {

// Counted at places that lie evenly in a cell: exact to about a tenth of what the surfaces leave
// open there.
class Overhang {
  public:
    Overhang(const TriangleTree& body, const TriMesh& inset, const MoldFrame& frame)
        : body_(body), inset_(inset), frame_(frame) {}

    // Of what the inset has of a cell in layer k, that part which is in the body as well; `whole`:
    // what the body has of it.
    CellFill within(const CellFill& share, int k, double whole) const;

  private:
    // Whether the inset seems to have all that the body has of the cell.
    bool covers(const CellFill& share, int k) const;

    const TriangleTree& body_;
    TriangleTree inset_;
    const MoldFrame& frame_;
};

}  // namespace swage
