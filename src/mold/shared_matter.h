// SPDX-License-Identifier: GPL-3.0-or-later
// How much matter of each cell of a body lies in each cell of what is molded anew in its place.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// What one material has of a cell.
struct MatterPart {
    CellId cell;
    std::size_t material;
    int mixed;      // of its cell's two materials that one; -1: the cell is of one
    double volume;  // at molding [m3]
    Vec3 centroid;  // in the cell, each -0.5 to 0.5
};

// In the order of their cells; in all of each material what material_volumes() has.
std::vector<MatterPart> matter_parts(const Aggregate& matter);

struct SharedMatter {
    int from, to;   // numbers of parts
    double volume;  // of `from` [m3]
};

// Calls see() with what each part of a body, where that is now, shares with those of the same
// material of another that nothing has moved since it was molded: in the order of `part`. Of each
// all is seen, but of those that have no such part in the cells around them.
void for_each_shared(const Aggregate& from, const std::vector<MatterPart>& part,
                     const Aggregate& to, const std::vector<MatterPart>& new_part,
                     const std::function<void(const SharedMatter&)>& see);

}  // namespace swage
