// SPDX-License-Identifier: GPL-3.0-or-later
// How the matter around a particle is stretched and turned: the deformation gradient F at the
// particle, from the displacements of the particles that are still connected to it.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "skin/loose_particles.h"

namespace swage {

// F - I by columns (9 numbers), then the displacement u = x - X [m]. All exactly zero in a body at
// rest, so that what follows it comes out to the bit.
using ParticleFrame = Eigen::Matrix<double, 12, 1>;

// The lattice neighbours of every particle, -1 for none, and where it was at molding. Derived from
// the lattice and how its cells are filled.
struct FrameStencil {
    Vec3Array reference;
    // Along axis d: [4d] two below, [4d + 1] one below, [4d + 2] one above, [4d + 3] two above.
    std::vector<std::array<ParticleId, 12>> axis;
    // Face diagonals d = 3 ... 8: [d - 3] the upper end, [d + 3] the lower end.
    std::vector<std::array<ParticleId, 12>> diagonal;
    LooseParticles loose;
};
FrameStencil make_frame_stencil(const Aggregate& matter);

// One frame for each of the particles asked for, loose ones taken to be where firm matter has them.
// Central differences along the lattice axes; at surfaces one-sided ones of second order, or first
// order in parts one cell thick. A particle that lacks an axis takes the least-squares fit over its
// connected neighbours, and theirs where that is too few, completed to a rotation where even those
// do not span the space.
void particle_frames(const Aggregate& matter, const FrameStencil& stencil,
                     const std::vector<ParticleId>& particle, std::vector<ParticleFrame>& frame);

}  // namespace swage
