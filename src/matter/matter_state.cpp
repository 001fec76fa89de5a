// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/matter_state.h"

namespace swage {

namespace {

// `of`: the aggregate, whose materials tell; of what goes by one name in it and in its state.
template <typename From, typename To>
void copy_state(const Aggregate& of, const From& from, To& to) {
    to.particle_position = from.particle_position;
    to.particle_velocity = from.particle_velocity;
    to.mixed_cell = from.mixed_cell;
    const bool breaks = of.breaks();
    if (!breaks && !of.yields()) return;
    for (int d = 0; d < kForwardCount; ++d) {
        to.connection[d].plastic = from.connection[d].plastic;
        if (!breaks) continue;
        to.connection[d].weight = from.connection[d].weight;
        to.connection[d].damage = from.connection[d].damage;
    }
    to.cell_cracked = from.cell_cracked;
    to.cell_set = from.cell_set;
    to.cell_history = from.cell_history;
    to.cell_back = from.cell_back;
    to.cell_plastic = from.cell_plastic;
}

}  // namespace

void MatterState::save(const Aggregate& matter) { copy_state(matter, matter, *this); }

void MatterState::restore(Aggregate& matter) const { copy_state(matter, *this, matter); }

}  // namespace swage
