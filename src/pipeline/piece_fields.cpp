// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_fields.h"

#include "sim/matter_stress.h"
#include "skin/skin_fields.h"

namespace swage {

SkinFieldValues fields_on_skin(const WorkPiece& piece, const std::vector<SkinField>& fields) {
    if (fields.empty()) return {};
    const std::vector<CellId> cells = cells_under(piece.mount, piece.matter);
    return skin_fields(piece.mount, piece.matter, stress_samples(piece.matter, cells), fields);
}

std::vector<SkinFieldValues> fields_on_skins(const std::vector<WorkPiece>& bodies,
                                             const std::vector<SkinField>& fields) {
    std::vector<SkinFieldValues> all;
    for (const WorkPiece& body : bodies) all.push_back(fields_on_skin(body, fields));
    return all;
}

}  // namespace swage
