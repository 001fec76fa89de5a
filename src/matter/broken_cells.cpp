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

}  // namespace swage
