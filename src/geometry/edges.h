// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a surface, each with all triangles that run along it.
#pragma once

#include <span>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

struct EdgeUse {
    int low, high;  // positions, low < high
    int triangle;
    int side;      // from corner `side` of the triangle to the next corner
    bool forward;  // the triangle runs from low to high
};

// Sorted by (low, high, triangle): uses of one edge stand together. Sides between equal positions
// are left out.
std::vector<EdgeUse> edge_uses(const std::vector<Corners>& triangle, std::size_t position_count);

// Of the uses of one edge, how many more run from low to high than back; 0 where it is closed.
int excess(std::span<const EdgeUse> uses);

// Whether every edge of it is closed; of no triangles too.
bool is_closed(const TriMesh& mesh);

// Calls f(std::span<const EdgeUse>) once an edge.
template <typename F>
void for_each_edge(const std::vector<EdgeUse>& uses, const F& f) {
    for (std::size_t begin = 0, end; begin < uses.size(); begin = end) {
        end = begin + 1;
        while (end < uses.size() && uses[end].low == uses[begin].low &&
               uses[end].high == uses[begin].high)
            ++end;
        f(std::span<const EdgeUse>(uses.data() + begin, end - begin));
    }
}

}  // namespace swage
