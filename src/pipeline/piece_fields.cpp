// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/piece_fields.h"

#include "sim/matter_stress.h"
#include "skin/skin_fields.h"

namespace swage {

namespace {

bool flows_by_another(const Aggregate& matter) {
    if (matter.material.mechanics == Mechanics::springs) return matter.yields();
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        if (matter.material_at(m).shifts()) return true;
    }
    return false;
}

}  // namespace

SkinFieldValues fields_at(const Mount& mount, const Aggregate& matter,
                          const std::vector<SkinField>& fields) {
    if (fields.empty()) return {};
    const std::vector<CellId> cells = cells_under(mount, matter);
    SkinFieldValues values = skin_fields(mount, matter, stress_samples(matter, cells), fields);
    // What counts for flow may be another stress.
    if (!flows_by_another(matter)) return values;
    for (std::size_t f = 0; f < fields.size(); ++f) {
        if (fields[f] != SkinField::yield_use) continue;
        const std::vector<StressSample> flow = stress_samples(matter, cells, Bears::of_flow);
        values[f] = skin_fields(mount, matter, flow, {fields[f]}).front();
    }
    return values;
}

SkinFieldValues fields_on_skin(const WorkPiece& piece, const std::vector<SkinField>& fields) {
    return fields_at(piece.mount, piece.matter, fields);
}

std::vector<SkinFieldValues> fields_on_skins(const std::vector<WorkPiece>& bodies,
                                             const std::vector<SkinField>& fields) {
    std::vector<SkinFieldValues> all;
    for (const WorkPiece& body : bodies) all.push_back(fields_on_skin(body, fields));
    return all;
}

}  // namespace swage
