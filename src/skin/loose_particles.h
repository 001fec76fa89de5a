// SPDX-License-Identifier: GPL-3.0-or-later
// Particles that only slivers hold: corners of cells that hold next to no material (kFirmFill). The
// material is not where they are but between them and firm cells, and where it flows far they are
// driven about by as much as a cell, which a skin must not follow.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct LooseParticles {
    struct Share {
        ParticleId particle;
        double weight;
    };
    std::vector<ParticleId> particle;  // ascending
    std::vector<int> slot;             // of every particle, -1: firmly held. Empty: all are
    // Where the firm cells nearest to a loose particle, each going on as it is strained in the
    // mean, would have it: into share, one more at the end. Exact for what is linear in the place.
    std::vector<int> first_share;
    std::vector<Share> share;
    // Cells that have to be whole for that, the particle's own slivers first: into need, one more
    // at the end.
    std::vector<int> first_need;
    std::vector<CellId> need;
    std::vector<int> sliver_count;
};

// Loose are those of whose cells none is firm while each adjoins one that is: so a fin thinner than
// a sliver, on a body, is left to itself.
LooseParticles find_loose(const Aggregate& matter);

// Displacements [m] of the loose particles that a skin follows: their own, as long as they stay
// within 0.15 spacings of where firm matter would have them, else at that distance from it. Where
// matter is severed or broken in between, the nearest whole firm cells count that a particle still
// hangs together with by one of its slivers; where there are none it goes its own way.
std::vector<Vec3> loose_displacements(const LooseParticles& loose, const Aggregate& matter,
                                      const Vec3Array& reference);

}  // namespace swage
