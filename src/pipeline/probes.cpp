// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/probes.h"

#include "base/units.h"
#include "geometry/box.h"

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
        skin_positions(bodies[b].probe, bodies[b].matter, place);
        for (std::size_t n = 0; n < place.size(); ++n) {
            all.push_back({specs[b].probe[n].name, place[n]});
        }
    }
    return all;
}

}  // namespace swage
