// SPDX-License-Identifier: GPL-3.0-or-later
// Forces found slab by slab and added up in the order of the slabs, so that the order of all sums,
// and with it every bit of the result, is the same for any number of threads.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct ForceSlab {
    ParticleId begin = 0, reach = 0;  // the particles that it may push: begin ... reach - 1
    Vec3Array part;                   // forces on these [N]

    void clear();
};

using ForceSlabs = std::vector<ForceSlab>;

// force = sum of the slabs' parts.
void sum_slabs(const ForceSlabs& slabs, std::size_t particles, Vec3Array& force);

}  // namespace swage
