// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/boundary_note.h"

#include <cmath>
#include <optional>

#include "base/units.h"
#include "skin/skin_volume.h"

namespace swage {

std::vector<std::string> boundary_notes(const std::vector<WorkPiece>& bodies) {
    constexpr double kOff = 0.01;
    std::vector<std::string> told;
    for (const WorkPiece& body : bodies) {
        if (!body.look) continue;
        const std::optional<double> skin = enclosed_volume(body.skin, body.skin.position);
        const double by = skin ? *skin / body.matter.volume() - 1 : 0;
        if (!(std::abs(by) > kOff)) continue;
        told.push_back(fmt::format(
            "the boundary of {} encloses {:.2g} % {} than its matter: it joins what lies nearer "
            "than a cell, {}, and cannot follow what is thinner; smaller cells make it less, "
            "skin.kind = \"mount\" avoids it",
            name_among(bodies, body), 100 * std::abs(by), by > 0 ? "more" : "less",
            quantity_text(body.matter.lattice.spacing, Quantity::length)));
    }
    return told;
}

}  // namespace swage
