// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on points of the surface whose cells a blade or a crack has torn.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "matter/cell_parts.h"
#include "matter/drive.h"

namespace swage {

// NOTE: a force on a torn cell would pull at both sides of the cut. It acts on the force's nearest
// point that is not torn or, where there is none near, on what carries most of its own.
struct Bearer {
    int point = 0;                     // of the surface
    CornerMask corners = kAllCorners;  // of its cell that carry it

    template <typename Io>
    void visit(Io& io) {
        io(point, corners);
    }
};
SurfacePoints::Carriers carriers_by(const Bearer& bearer, const Aggregate& matter);

// Of each of a force's points; empty: none is torn. `before`: as they were before more was torn.
std::vector<Bearer> bearers(const Load& load, const Aggregate& matter,
                            const std::vector<Bearer>& before);

}  // namespace swage
