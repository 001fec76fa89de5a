// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include <limits>

#include "geometry/box.h"
#include "geometry/near_pairs.h"
#include "matter/cell_middle.h"

namespace swage {

void carry_hardening(const Aggregate& from, Aggregate& to) {
    if (from.cell_hardening.empty()) return;
    std::vector<Box> box;
    std::vector<Vec3> middle;
    for (std::size_t c = 0; c < from.cell_fill.size(); ++c) {
        box.emplace_back();
        for (ParticleId p : from.lattice.cell_corners(static_cast<CellId>(c))) {
            box.back().grow(from.particle_position.at(p));
        }
        middle.push_back(cell_middle(from, static_cast<CellId>(c)));
    }
    const std::size_t count = to.cell_fill.size();
    std::vector<Vec3> place;
    for (std::size_t c = 0; c < count; ++c) {
        place.push_back(cell_middle(to, static_cast<CellId>(c)) +
                        to.lattice.spacing * to.cell_centroid[c].cast<double>());
    }
    const auto far = [&](std::size_t cell, std::size_t other) {
        return (place[cell] - middle[other]).squaredNorm();
    };
    // Of the cells whose box holds the place that with the nearest middle; outside all, of all.
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> like(count, kNone);
    for (const auto& [point, other] : near_pairs(place, box)) {
        const auto cell = static_cast<std::size_t>(point), at = static_cast<std::size_t>(other);
        if (like[cell] == kNone || far(cell, at) < far(cell, like[cell])) like[cell] = at;
    }
    to.cell_hardening.assign(count, 0.0f);
    for (std::size_t c = 0; c < count; ++c) {
        if (like[c] == kNone) {
            like[c] = 0;
            for (std::size_t n = 1; n < middle.size(); ++n) {
                if (far(c, n) < far(c, like[c])) like[c] = n;
            }
        }
        to.cell_hardening[c] = from.cell_hardening[like[c]];
    }
    if (to.material.mechanics == Mechanics::springs) {
        for (auto& slot : to.cell_plastic) slot.assign(count, 0.0f);
        return;
    }
    for (auto& part : to.cell_plastic_stretch) part.assign(count, 0.0f);
    for (auto& part : to.cell_plastic_modes) part.assign(count, 0.0f);
}

}  // namespace swage
