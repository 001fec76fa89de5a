// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes of a spline space (sim/spline_space.h) the matter follows. A node reaches three
// elements along each axis. What it moves there and hangs together only beyond its reach, or not at
// all, follows a node of its own at that place: splines do not reach over gaps and cuts.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct SplineParts {
    // What hangs together within an element; it follows 27 nodes, those along x first.
    static constexpr int kNodes = 27;
    using Nodes = std::array<int, kNodes>;

    std::vector<int> of_particle;
    std::vector<Nodes> node;   // of each part
    std::vector<Vec3i> place;  // of each node on the grid, the first node of each place in order

    // `element`: of each site along x, y and z.
    SplineParts(const Lattice& lattice,
                const std::array<ConnectionArrays, kForwardCount>& connection,
                const std::array<std::vector<int>, 3>& element, const Vec3i& elements);
};

}  // namespace swage
