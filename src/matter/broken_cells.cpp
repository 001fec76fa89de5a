// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/broken_cells.h"

#include <algorithm>

namespace swage {

bool any_damaged(const Aggregate& matter) {
    return !matter.cell_cracked.empty() ||
           std::any_of(matter.connection.begin(), matter.connection.end(),
                       [](const ConnectionArrays& all) { return !all.damage.empty(); });
}

bool cell_has_broken(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row) {
    if (!matter.cell_cracked.empty() && matter.cell_cracked[cell] != 0) return true;
    return !cell_is_whole(matter, row) &&
           std::any_of(kCellConnection.begin(), kCellConnection.end(), [&](const auto& c) {
               const std::vector<float>& damage = matter.connection[c.direction].damage;
               return !damage.empty() && damage[corner_particle(row, c.corner)] > 0;
           });
}

bool closes_as_crack(const Aggregate& matter, const std::array<ParticleId, 4>& row, int axis) {
    bool broken = false;
    for (const CellConnection& c : kCellConnection) {
        const ConnectionArrays& all = matter.connection[c.direction];
        const ParticleId lower = corner_particle(row, c.corner);
        if (all.weight[lower] > 0) continue;
        const bool by_load = !all.damage.empty() && all.damage[lower] >= 1;
        if (!by_load && c.direction == axis) return false;  // kForward begins with the edges
        broken = broken || by_load;
    }
    return broken;
}

}  // namespace swage
