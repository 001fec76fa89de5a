// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/probes.h"

#include <algorithm>

#include "base/units.h"
#include "geometry/box.h"
#include "pipeline/piece_fields.h"

namespace swage {

namespace {

constexpr double kBeside = 0.5;  // spacings from the nearest cell

}  // namespace

Mount mount_probes(const BodySpec& body, const TriMesh& mesh, const Aggregate& matter) {
    std::vector<Vec3> place;
    const Box box = box_of(mesh.position);
    for (const ProbeSpec& probe : body.probe) {
        place.push_back(box.low + probe.at.cwiseProduct(box.size()));
        const CellBox cell = cell_box(matter, carrying_cell(matter, place.back()));
        const double off =
            (place.back() - place.back().cwiseMax(cell.low).cwiseMin(cell.low + cell.size)).norm();
        if (off > kBeside * matter.lattice.spacing) {
            throw SceneError({mistake_at(
                probe.place, fmt::format("probe \"{}\" is {} outside the matter", probe.name,
                                         quantity_text(off, Quantity::length)))});
        }
    }
    return mount_mesh(place, matter, SkinKind::mount);
}

std::vector<ProbePlace> probe_places(const std::vector<BodySpec>& specs,
                                     const std::vector<WorkPiece>& bodies) {
    std::vector<ProbePlace> all;
    std::vector<Vec3> place;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (specs[b].probe.empty()) continue;
        const Mount& mount = bodies[b].probe;
        skin_positions(mount, bodies[b].matter, place);
        std::vector<SkinField> asked;
        for (const ProbeSpec& probe : specs[b].probe) {
            asked.insert(asked.end(), probe.fields.begin(), probe.fields.end());
        }
        std::sort(asked.begin(), asked.end());
        asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
        const SkinFieldValues values = fields_at(mount, bodies[b].matter, asked);
        for (std::size_t n = 0; n < place.size(); ++n) {
            const ProbeSpec& probe = specs[b].probe[n];
            all.push_back({probe.name, place[n], probe.fields});
            for (const SkinField field : probe.fields) {
                const auto at = std::lower_bound(asked.begin(), asked.end(), field);
                all.back().value.push_back(values[at - asked.begin()][n]);
            }
        }
    }
    return all;
}

}  // namespace swage
