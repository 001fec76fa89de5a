// SPDX-License-Identifier: GPL-3.0-or-later
// The motion to which a body at rest offers the least stiffness for its mass, followed from one
// equilibrium to the next: when its stiffness falls below zero the body buckles. Locally optimal
// preconditioned conjugate gradients for one eigenvector (Knyazev, SIAM J. Sci. Comput. 23, 2001).
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

class SoftMode {
  public:
    using Map = std::function<void(const Vec3Array& from, Vec3Array& to)>;

    // Comes closer to the softest motion under this stiffness, of those that have nothing of what
    // is `free` (sim/free_motions.h); `solve` is about its inverse. Returns the quotient of
    // stiffness and mass, which is never below the true one [1/s2].
    double follow(const Vec3Array& position, const std::vector<double>& mass,
                  const std::vector<Vec3Array>& free, const Map& product, const Map& solve);

    const Vec3Array& motion() const { return motion_; }  // of any length

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(motion_, last_);
    }

  private:
    Vec3Array motion_, last_;  // the last step towards it
};

}  // namespace swage
