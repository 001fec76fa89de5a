// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff the connections of a body of several materials are. Each cell gives those in it their
// share of its own material, a cell of two what its laminate has along them: with the angle t
// between connection and normal of the boundary
//
//     k / k_0 = f [cos^2 t / sum(f_m E_0 / (f E_m)) + sin^2 t sum(f_m E_m / (f E_0))]
//
// k_0: of a full connection of the body's own material, E_0; f_m: shares of the cell's volume.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Of a connection, that lies in each of the cells around it where these are whole.
inline double cell_share(int direction) { return direction < kEdgeCount ? 0.25 : 0.5; }

// By material; empty: all count.
using MaterialMask = std::vector<char>;

// k / k_0 of a whole connection in this direction, were all of them in this cell; of materials that
// do not count, without what they store of its energy. `mixed`: the cell's, or null.
double stiffness_in(const Aggregate& matter, CellId cell, const MixedCell* mixed, int direction,
                    const MaterialMask& counts = {});

class ConnectionShares {
  public:
    ConnectionShares() = default;  // of one material: the weights
    ConnectionShares(const Aggregate& matter, const MaterialMask& counts);

    // k / k_0, 0 where the connection is severed or broken.
    float of(const Aggregate& matter, int direction, ParticleId lower) const {
        const float weight = matter.connection[direction].weight[lower];
        return share_[0].empty() || !(weight > 0) ? weight : share_[direction][lower];
    }
    void copy(const Aggregate& matter, int direction, ParticleId first, int count, float* to) const;

    template <typename Io>
    void visit(Io& io) {
        io(share_);
    }

  private:
    std::array<std::vector<float>, kForwardCount> share_;
};

// Materials of a body that lose the same share of every swing.
struct DampedMaterials {
    double damping_ratio;  // > 0
    MaterialMask counts;
};
std::vector<DampedMaterials> damped_materials(const Aggregate& matter);

}  // namespace swage
