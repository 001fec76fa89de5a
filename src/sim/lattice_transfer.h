// SPDX-License-Identifier: GPL-3.0-or-later
// Between a lattice and a coarser one whose sites are every `ratio`-th of its own: the finer
// particles follow the corners of their coarse cell trilinearly.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// The coarse lattice: every cell that holds a finer one. Spacing and origin mean nothing in it.
Lattice coarse_lattice(const Lattice& fine, const Vec3i& ratio);

// Number of particles of a lattice.
std::size_t particle_count(const Lattice& lattice);

class LatticeTransfer {
  public:
    LatticeTransfer(const Lattice& fine, const Lattice& coarse, const Vec3i& ratio);

    // fine += P coarse
    void add_prolonged(const Vec3Array& coarse, Vec3Array& fine) const;
    // coarse = P^T fine
    void restricted(const Vec3Array& fine, Vec3Array& coarse) const;

  private:
    // Fine particles first ... first + count - 1 of one row, and the coarse rows beside them.
    struct Stretch {
        ParticleId first;
        int count;
        int phase;          // of the first particle in its coarse cell along x
        ParticleId row[4];  // the coarse particle at or below the first one, by (y, z) side
        double weight[4];   // 0: no such row is needed
    };
    struct Pull {  // what one coarse run takes from one stretch, by side
        int stretch, side;
    };
    int ratio_;  // along x
    std::vector<Stretch> stretch_;
    std::vector<ParticleRun> coarse_run_;
    std::vector<int> pull_begin_;  // by coarse run, one more at the end
    std::vector<Pull> pull_;
};

}  // namespace swage
