// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/cells_there.h"

#include "geometry/box.h"
#include "geometry/near_pairs.h"
#include "matter/cell_middle.h"

namespace swage {

std::vector<CellId> cells_there(const Aggregate& body, const std::vector<Vec3>& place,
                                double wider) {
    std::vector<Box> box;
    std::vector<Vec3> middle;
    for (std::size_t c = 0; c < body.cell_fill.size(); ++c) {
        Box around;
        for (ParticleId p : body.lattice.cell_corners(static_cast<CellId>(c))) {
            around.grow(body.particle_position.at(p));
        }
        box.push_back(around.widened(wider));
        middle.push_back(cell_middle(body, static_cast<CellId>(c)));
    }
    const auto far = [&](std::size_t at, CellId cell) {
        return (place[at] - middle[static_cast<std::size_t>(cell)]).squaredNorm();
    };
    constexpr CellId kNone = -1;
    std::vector<CellId> there(place.size(), kNone);
    for (const auto& [point, other] : near_pairs(place, box)) {
        const auto at = static_cast<std::size_t>(point);
        const auto cell = static_cast<CellId>(other);
        if (there[at] == kNone || far(at, cell) < far(at, there[at])) there[at] = cell;
    }
    for (std::size_t at = 0; at < place.size(); ++at) {
        if (there[at] != kNone) continue;
        there[at] = 0;
        for (std::size_t n = 1; n < middle.size(); ++n) {
            const auto cell = static_cast<CellId>(n);
            if (far(at, cell) < far(at, there[at])) there[at] = cell;
        }
    }
    return there;
}

}  // namespace swage
