// SPDX-License-Identifier: GPL-3.0-or-later
// What of a body's surface and of the paths of blades lies near some of its particles: sorted into
// bins once, for all of its pieces without a whole cell.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Numbers of places by the cell that they lie in.
class CellBins {
  public:
    // The next place's cell. All are added before any is sought.
    void add(const Vec3i& cell);
    void sort();
    // In their order, at least all that lie within `low` to `high` cells of any of the sites.
    std::vector<int> around(const std::vector<Vec3i>& sites, int low, int high) const;

  private:
    std::vector<std::pair<std::uint64_t, int>> at_;  // by bin
    int count_ = 0;
};

struct ThinNear {
    explicit ThinNear(const Aggregate& of);

    CellBins cut;    // Aggregate::cut, by the cells that hold the points
    CellBins point;  // its surface points that cells carry, by these
};

}  // namespace swage
