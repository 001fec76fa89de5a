// SPDX-License-Identifier: GPL-3.0-or-later
// A stiffness matrix over the particles of a lattice, each coupled to its 26 neighbours, by blocks
// of three.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_tangent.h"

namespace swage {

class NodeStiffness {
  public:
    static constexpr int kNear = 27;  // dx + 1 + 3 (dy + 1) + 9 (dz + 1); 13 is the particle itself

    explicit NodeStiffness(const Lattice& lattice);

    void clear();
    void add_cells(const Lattice& lattice, const std::vector<CellMatrix>& cells);
    // Adds w_a w_b K between the eight corners of a cell.
    void add_point(const std::array<ParticleId, 8>& corner, const std::array<double, 8>& weight,
                   const Mat3& stiffness);
    void add_diagonal(ParticleId p, double stiffness);

    // result = K x
    void product(const Vec3Array& x, Vec3Array& result) const;

    std::size_t size() const { return neighbour_.size() / kNear; }
    // -1: none there.
    ParticleId neighbour(ParticleId p, int near) const { return neighbour_[p * kNear + near]; }
    const Mat3& block(ParticleId p, int near) const {
        return block_[p * std::size_t(kNear) + near];
    }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(block_);
    }

  private:
    std::vector<ParticleId> neighbour_;
    std::vector<Mat3> block_;
};

}  // namespace swage
