// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include "matter/cell_middle.h"
#include "mold/cells_there.h"

namespace swage {

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (from.cell_history.empty()) return;
    const std::size_t count = to.cell_fill.size();
    std::vector<Vec3> place;
    for (std::size_t c = 0; c < count; ++c) {
        place.push_back(cell_middle(to, static_cast<CellId>(c)) +
                        to.lattice.spacing * to.cell_centroid[c].cast<double>());
    }
    const std::vector<CellId> like = cells_there(from, place);
    std::vector<float>& hardening = to.cell_history.hardening();
    if (to.material.mechanics == Mechanics::springs) {
        for (auto& slot : to.cell_plastic) slot.assign(count, 0.0f);
        hardening.resize(count);
    } else {
        to.cell_history.assign(count);
    }
    for (std::size_t c = 0; c < count; ++c) {
        hardening[c] = from.cell_history.hardening()[static_cast<std::size_t>(like[c])];
    }
}

}  // namespace swage
