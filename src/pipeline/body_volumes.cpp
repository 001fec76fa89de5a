// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_volumes.h"

#include <cmath>
#include <map>

#include "geometry/disjoint_sets.h"
#include "geometry/mesh_check.h"
#include "pipeline/json.h"
#include "sim/cell_volume.h"
#include "sim/flowed_volume.h"
#include "skin/broken_skin.h"
#include "skin/piece_map.h"
#include "skin/skin_volume.h"

namespace swage {

std::vector<BodyVolume> body_volumes(const std::vector<WorkPiece>& bodies) {
    std::vector<BodyVolume> volumes;
    for (const WorkPiece& body : bodies) {
        const std::optional<PieceOff> piece = piece_off(body);
        volumes.push_back({present_volume(body.matter), flowed_volume(body.matter),
                           enclosed_volume(body.skin, body.position), boundary_off(body),
                           piece ? piece->by : 0});
    }
    return volumes;
}

std::optional<double> boundary_off(const WorkPiece& body) {
    if (!body.look) return {};
    const std::optional<double> skin = enclosed_volume(body.skin, body.skin.position);
    if (!skin) return {};
    return *skin / body.matter.volume() - 1;
}

Json volumes_json(const std::vector<WorkPiece>& bodies, const std::vector<BodyVolume>& at_start) {
    const std::vector<BodyVolume> now = body_volumes(bodies);
    Json json = Json::object();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        Json& own = json[bodies[b].name];
        own["matter_at_start"] = at_start[b].matter;
        own["matter"] = now[b].matter;
        if (at_start[b].skin) own["skin_at_start"] = *at_start[b].skin;
        if (now[b].skin) own["skin"] = *now[b].skin;
    }
    return json;
}

std::optional<double> swollen_by(const WorkPiece& body) {
    if (!keeps_volume(body)) return {};
    const std::optional<double> was = enclosed_volume(body.skin, body.skin.position),
                                is = enclosed_volume(body.skin, body.position);
    if (!was || !is || !(*was > 0)) return {};
    return *is / *was - present_volume(body.matter) / body.matter.volume();
}

namespace {

// What the skin of pieces encloses that share a part of it, and by how much their matter has grown.
struct PieceVolumes {
    double was = 0, is = 0;          // of the skin [m3]
    double molded = 0, present = 0;  // of sound cells, in cells
    std::optional<Vec3> origin_was, origin_is;
    bool spans = false;

    void add(const TriMesh& skin, const std::vector<Vec3>& position, const Corners& triangle) {
        const auto part = [&](const std::vector<Vec3>& at, std::optional<Vec3>& origin) {
            if (!origin) origin = at[triangle[0]];
            return area_vector(at, triangle).dot(at[triangle[0]] - *origin) / 6;
        };
        was += part(skin.position, origin_was);
        is += part(position, origin_is);
    }
};

// By the lowest of the pieces that are one by their skin.
std::map<int, PieceVolumes> volumes_by_piece(const WorkPiece& body) {
    const TriMesh& skin = body.skin;
    const PieceMap map(body.matter);
    const Components parts = surface_components(skin);
    DisjointSets joined(static_cast<std::size_t>(map.pieces().count));
    std::vector<int> of_vertex(skin.position.size(), -1);
    std::vector<int> of_part(static_cast<std::size_t>(parts.count), -1);
    std::vector<char> spans(of_part.size(), 0);
    for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
        const auto part = static_cast<std::size_t>(parts.triangle_component[t]);
        for (const int v : skin.triangle[t]) {
            int& piece = of_vertex[v];
            if (piece < 0) piece = map.piece_of(body.mount.place(v));
            if (of_part[part] < 0) of_part[part] = piece;
            spans[part] = spans[part] || piece != of_part[part];
            joined.unite(of_part[part], piece);
        }
    }
    std::map<int, PieceVolumes> volumes;
    const auto of_piece = [&](int piece) -> PieceVolumes& { return volumes[joined.root(piece)]; };
    for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
        const auto part = static_cast<std::size_t>(parts.triangle_component[t]);
        PieceVolumes& own = of_piece(of_part[part]);
        own.add(skin, body.position, skin.triangle[t]);
        own.spans = own.spans || spans[part];
    }
    for (const CellRun& run : body.matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            if (!cell_is_sound(body.matter, cell, run.row_at(n))) continue;
            PieceVolumes& own = of_piece(map.pieces().particle_piece[run.corner(n, 0)]);
            const double fill = body.matter.cell_fill[cell];
            own.molded += fill;
            own.present += fill * material_gradient(body.matter, run, n).determinant();
        }
    }
    return volumes;
}

}  // namespace

std::optional<PieceOff> piece_off(const WorkPiece& body) {
    constexpr double kCrumb = 0.01;  // of all that the skin encloses
    const bool is_made_anew = body.look && is_broken(body.matter);
    const std::optional<double> whole = enclosed_volume(body.skin, body.skin.position);
    if (is_made_anew || !whole || !(*whole > 0) || body.position.empty()) return {};
    if (!body.is_parted && find_pieces(body.matter).count < 2) return {};
    const std::map<int, PieceVolumes> volumes = volumes_by_piece(body);
    const double share_of_all = present_volume(body.matter) / body.matter.volume();
    PieceOff most{0, false, volumes.size() > 1};
    for (const auto& [piece, own] : volumes) {
        if (own.was < kCrumb * *whole) continue;
        const double matter = own.molded > 0 ? own.present / own.molded : share_of_all;
        const double by = own.is / own.was - matter;
        if (std::abs(by) > std::abs(most.by)) most.by = by, most.spans = own.spans;
    }
    return most;
}

}  // namespace swage
