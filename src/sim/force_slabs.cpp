// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/force_slabs.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

SWAGE_VECTOR_CLONES
void add_block(const double* __restrict f, std::size_t count, double* __restrict sum) {
    for (std::size_t n = 0; n < count; ++n) sum[n] += f[n];
}

}  // namespace

void ForceSlab::clear() {
    for (auto* component : {&part.x, &part.y, &part.z}) {
        std::fill(component->begin(), component->end(), 0.0);
    }
}

void sum_slabs(const ForceSlabs& slabs, std::size_t particles, Vec3Array& force) {
    force.resize(particles);
    const std::size_t chunks = std::max<std::size_t>(1, slabs.size());
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t begin = particles * chunk / chunks;
        const std::size_t end = particles * (chunk + 1) / chunks;
        std::fill(force.x.begin() + begin, force.x.begin() + end, 0.0);
        std::fill(force.y.begin() + begin, force.y.begin() + end, 0.0);
        std::fill(force.z.begin() + begin, force.z.begin() + end, 0.0);
        for (const ForceSlab& slab : slabs) {
            const std::size_t from = std::max<std::size_t>(begin, slab.begin);
            const std::size_t to = std::min<std::size_t>(end, slab.reach);
            if (from >= to) continue;
            add_block(slab.part.x.data() + (from - slab.begin), to - from, force.x.data() + from);
            add_block(slab.part.y.data() + (from - slab.begin), to - from, force.y.data() + from);
            add_block(slab.part.z.data() + (from - slab.begin), to - from, force.z.data() + from);
        }
    });
}

}  // namespace swage
