// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/whole_parts.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "skin/piece_map.h"

namespace swage {

namespace {

struct Part {
    std::vector<int> vertex;
    std::map<int, int> whole, severed;  // by piece, vertices that such cells carry

    // That all of it is to follow; -1: it does already, or has been run through.
    int piece() const {
        std::map<int, int> all = whole;
        for (const auto& [piece, count] : severed) all[piece] += count;
        if (all.size() < 2 || whole.size() > 1) return -1;
        if (!whole.empty()) return whole.begin()->first;
        return std::ranges::max_element(all, {}, &std::pair<const int, int>::second)->first;
    }
};

std::vector<Part> parts_of(const TriMesh& skin) {
    const Components components = surface_components(skin);
    std::vector<Part> part(static_cast<std::size_t>(components.count));
    std::vector<char> is_seen(skin.position.size(), 0);
    for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
        for (const int v : skin.triangle[t]) {
            if (is_seen[v]) continue;
            is_seen[v] = 1;
            part[components.triangle_component[t]].vertex.push_back(v);
        }
    }
    return part;
}

// The nearest of the cells that carry the part in which the piece has corners.
CellSide own_cell(const Part& part, const Mount& mount, const PieceMap& map, const Vec3& place,
                  int piece) {
    CellSide best;
    double least = std::numeric_limits<double>::infinity();
    for (const int v : part.vertex) {
        const double distance = (mount.reference[v] - place).squaredNorm();
        if (distance >= least || map.piece_of(mount.place(v)) != piece) continue;
        least = distance;
        best = {mount.cell[v], map.side_of_piece(mount.cell[v], mount.reference[v], piece)};
    }
    return best;
}

}  // namespace

void follow_one_piece(const TriMesh& skin, Mount& mount, const Aggregate& matter) {
    const PieceMap map(matter);
    if (map.pieces().count < 2) return;
    std::vector<Part> parts = parts_of(skin);
    bool is_changed = false;
    for (Part& part : parts) {
        std::vector<int> piece_of;
        for (const int v : part.vertex) {
            const bool whole =
                corners_hang_together(matter, matter.lattice.cell_corners(mount.cell[v]));
            piece_of.push_back(map.piece_of(mount.place(v)));
            ++(whole ? part.whole : part.severed)[piece_of.back()];
        }
        const int piece = part.piece();
        if (piece < 0) continue;
        for (std::size_t n = 0; n < part.vertex.size(); ++n) {
            if (piece_of[n] == piece) continue;
            const int v = part.vertex[n];
            const Vec3& place = mount.reference[v];
            CellSide best = nearest_side(
                matter, mount.cell[v], place,
                [&](CellId cell, const Vec3i&) { return map.side_of_piece(cell, place, piece); });
            if (best.cell < 0) best = own_cell(part, mount, map, place, piece);
            mount.cell[v] = best.cell;
            mount.side[v] = best.side;
            is_changed = true;
        }
    }
    if (is_changed) finish_mount(mount, matter);
}

namespace {

// What is to carry all of the part that it may follow the piece; nothing where some of it is no
// cell away from any corner of it.
std::optional<std::vector<CellSide>> carried_by(const Part& part, const std::vector<int>& piece_of,
                                                int piece, const Mount& mount, const PieceMap& map,
                                                const Aggregate& matter) {
    std::vector<CellSide> all;
    for (std::size_t n = 0; n < part.vertex.size(); ++n) {
        const int v = part.vertex[n];
        const Vec3& place = mount.reference[v];
        CellSide own{mount.cell[v], mount.side[v]};
        if (piece_of[n] != piece) {
            own = nearest_side(matter, mount.cell[v], place, [&](CellId cell, const Vec3i&) {
                return map.side_of_piece(cell, place, piece);
            });
        }
        if (own.cell < 0) return std::nullopt;
        all.push_back(own);
    }
    return all;
}

}  // namespace

bool follow_piece_beside(const TriMesh& skin, Mount& mount, const Aggregate& matter) {
    const PieceMap map(matter);
    bool is_changed = false, all = true;
    for (const Part& part : parts_of(skin)) {
        std::vector<int> piece_of;
        std::map<int, int> count;
        for (const int v : part.vertex) {
            piece_of.push_back(map.piece_of(mount.place(v)));
            ++count[piece_of.back()];
        }
        if (count.size() < 2) continue;
        std::vector<std::pair<int, int>> order(count.begin(), count.end());
        std::ranges::stable_sort(order, std::ranges::greater(), &std::pair<int, int>::second);
        bool follows = false;
        for (const auto& [piece, vertices] : order) {
            const auto carried = carried_by(part, piece_of, piece, mount, map, matter);
            if (!carried) continue;
            for (std::size_t n = 0; n < part.vertex.size(); ++n) {
                mount.cell[part.vertex[n]] = (*carried)[n].cell;
                mount.side[part.vertex[n]] = (*carried)[n].side;
            }
            is_changed = follows = true;
            break;
        }
        all = all && follows;
    }
    if (is_changed) finish_mount(mount, matter);
    return all;
}

}  // namespace swage
