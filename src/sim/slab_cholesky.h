// SPDX-License-Identifier: GPL-3.0-or-later
// Direct solution over a lattice, slab by slab along its longest axis: particles of one slab are
// coupled to those of the next only, so the factor of their matrix is a chain of dense blocks.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "sim/node_stiffness.h"

namespace swage {

// Multiplications that the factor of a lattice takes.
double slab_cholesky_work(const Lattice& lattice);

class SlabCholesky {
  public:
    explicit SlabCholesky(const Lattice& lattice);

    // False: the matrix is not positive definite.
    bool factor(const NodeStiffness& matrix);
    // x = K^-1 b
    void solve(const Vec3Array& b, Vec3Array& x) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(diagonal_, below_);
    }

  private:
    std::vector<std::vector<ParticleId>> slab_;
    std::vector<int> place_;  // of each particle in its slab
    std::vector<int> slab_of_;
    std::vector<Eigen::MatrixXd> diagonal_;  // lower factors
    std::vector<Eigen::MatrixXd> below_;     // from each slab to the next
};

}  // namespace swage
