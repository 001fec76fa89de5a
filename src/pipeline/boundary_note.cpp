// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/boundary_note.h"

#include <cmath>

#include "base/units.h"
#include "pipeline/body_volumes.h"
#include "skin/broken_skin.h"

namespace swage {

namespace {

std::string cause(const WorkPiece& body) {
    const std::string cell = quantity_text(body.matter.lattice.spacing, Quantity::length);
    if (body.is_torn || is_broken(body.matter)) {
        return fmt::format(
            "it was made anew around the pieces, and where these are hardly wider than a cell, {}, "
            "it goes along the cells lest it run through itself; smaller cells make it less",
            cell);
    }
    return fmt::format(
        "it joins what lies nearer than a cell, {}, and cannot follow what is thinner; smaller "
        "cells make it less, skin.kind = \"mount\" avoids it",
        cell);
}

}  // namespace

std::string boundary_note(const std::vector<WorkPiece>& bodies, const WorkPiece& body) {
    constexpr double kOff = 0.01;
    const double by = boundary_off(body).value_or(0);
    if (!(std::abs(by) > kOff)) return {};
    return fmt::format("the boundary of {} encloses {:.2g} % {} than its matter: {}",
                       name_among(bodies, body), 100 * std::abs(by), by > 0 ? "more" : "less",
                       cause(body));
}

std::vector<std::string> boundary_notes(const std::vector<WorkPiece>& bodies) {
    std::vector<std::string> told;
    for (const WorkPiece& body : bodies) {
        if (std::string note = boundary_note(bodies, body); !note.empty()) {
            told.push_back(std::move(note));
        }
    }
    return told;
}

}  // namespace swage
