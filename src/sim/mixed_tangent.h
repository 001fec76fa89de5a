// SPDX-License-Identifier: GPL-3.0-or-later
// The tangent of the cells that hold two materials: how the forces of their laminates
// (laws/laminate.h) change with the positions, the jump at the boundary following.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_matrix.h"
#include "sim/mixed_cells.h"

namespace swage {

class MixedTangent {
  public:
    // Cells with `carried` 0 are left out.
    MixedTangent(const Aggregate& matter, const std::vector<float>& carried);

    bool empty() const { return batches_.cell.empty(); }
    std::size_t size() const { return batches_.cell.size(); }
    const std::array<ParticleId, 8>& corner(std::size_t n) const { return batches_.corner[n]; }
    Vec3i site(std::size_t n) const { return site_[n]; }

    // The particles have moved, or flow was committed.
    void forget() { known_.clear(); }

    // Minus the slope of each cell's forces at the present positions. Found once until forgotten.
    const std::vector<CellMatrix>& matrices(const Aggregate& matter, TangentKind kind) const;

    // result += matrices direction
    void add_product(const Aggregate& matter, TangentKind kind, const Vec3Array& direction,
                     Vec3Array& result);

  private:
    MixedBatches batches_;
    std::vector<Vec3i> site_;
    struct Known {
        TangentKind kind;
        std::vector<CellMatrix> matrix;
    };
    mutable std::vector<Known> known_;
    std::vector<std::array<double, 24>> push_;
};

}  // namespace swage
