// SPDX-License-Identifier: GPL-3.0-or-later
// What of an inset lies within the body, of cells that the surfaces of both run through.
#pragma once

#include "geometry/triangle_tree.h"
#include "mold/shares.h"

namespace swage {

// Where their surfaces cannot be cut along each other. Counted at places that lie evenly in a cell:
// exact to about a tenth of what the surfaces leave open there.
class Overhang {
  public:
    Overhang(const TriangleTree& body, const TriMesh& inset, const MoldFrame& frame)
        : body_(body), inset_(inset), frame_(frame) {}

    // Of what the inset has of a cell in layer k, that part which is in the body as well; `whole`:
    // what the body has of it.
    CellFill within(const CellFill& share, int k, double whole) const;

  private:
    const TriangleTree& body_;
    TriangleTree inset_;
    const MoldFrame& frame_;
};

}  // namespace swage
