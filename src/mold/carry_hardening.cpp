// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include "matter/cell_middle.h"
#include "mold/cells_there.h"

namespace swage {

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (from.cell_hardening.empty()) return;
    const std::size_t count = to.cell_fill.size();
    std::vector<Vec3> place;
    for (std::size_t c = 0; c < count; ++c) {
        place.push_back(cell_middle(to, static_cast<CellId>(c)) +
                        to.lattice.spacing * to.cell_centroid[c].cast<double>());
    }
    const std::vector<CellId> like = cells_there(from, place);
    to.cell_hardening.assign(count, 0.0f);
    for (std::size_t c = 0; c < count; ++c) {
        to.cell_hardening[c] = from.cell_hardening[static_cast<std::size_t>(like[c])];
    }
    if (to.material.mechanics == Mechanics::springs) {
        for (auto& slot : to.cell_plastic) slot.assign(count, 0.0f);
        return;
    }
    for (auto& part : to.cell_plastic_stretch) part.assign(count, 0.0f);
    for (auto& part : to.cell_plastic_modes) part.assign(count, 0.0f);
}

}  // namespace swage
