// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_pieces.h"

#include <algorithm>
#include <numeric>

#include "geometry/disjoint_sets.h"
#include "skin/piece_map.h"

namespace swage {

std::vector<int> skin_pieces(const TriMesh& skin, const Mount& mount, const Aggregate& matter) {
    std::vector<int> of_triangle(skin.triangle.size(), 0);
    const PieceMap map(matter);
    const Pieces& pieces = map.pieces();
    if (pieces.count < 2) return of_triangle;
    std::vector<int> of_vertex(skin.position.size(), -1);
    DisjointSets joined(static_cast<std::size_t>(pieces.count));
    std::vector<char> is_seen(static_cast<std::size_t>(pieces.count), 0);
    for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
        for (const int v : skin.triangle[t]) {
            if (of_vertex[v] < 0) of_vertex[v] = map.piece_of(mount.place(v));
            joined.unite(of_vertex[skin.triangle[t][0]], of_vertex[v]);
        }
        of_triangle[t] = of_vertex[skin.triangle[t][0]];
    }
    for (const int piece : of_triangle) is_seen[joined.root(piece)] = 1;
    std::vector<double> mass(is_seen.size(), 0.0);
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        mass[joined.root(pieces.particle_piece[p])] += matter.particle_mass[p];
    }
    std::vector<int> order(is_seen.size());
    std::iota(order.begin(), order.end(), 0);
    std::erase_if(order, [&](int piece) { return !is_seen[piece]; });
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return mass[a] > mass[b]; });
    std::vector<int> number(is_seen.size(), -1);
    for (std::size_t n = 0; n < order.size(); ++n) number[order[n]] = static_cast<int>(n);
    for (int& piece : of_triangle) piece = number[joined.root(piece)];
    return of_triangle;
}

std::vector<SkinShare> skin_shares(const TriMesh& skin, const Mount& mount,
                                   const Aggregate& matter) {
    const PieceMap map(matter);
    const Components parts = surface_components(skin);
    constexpr int kNone = -1, kSeveral = -2;
    std::vector<int> piece_of_part(static_cast<std::size_t>(parts.count), kNone);
    std::vector<int> of_vertex(skin.position.size(), kNone);
    const auto for_each_use = [&](const auto& visit) {
        for (std::size_t t = 0; t < skin.triangle.size(); ++t) {
            for (const int v : skin.triangle[t]) {
                visit(piece_of_part[parts.triangle_component[t]], of_vertex[v], v);
            }
        }
    };
    for_each_use([&](int& of_part, int& piece, int v) {
        if (piece == kNone) piece = map.piece_of(mount.place(v));
        if (of_part == kNone) of_part = piece;
        if (of_part != piece) of_part = kSeveral;
    });
    std::vector<SkinShare> share(static_cast<std::size_t>(map.pieces().count), SkinShare::none);
    for_each_use([&](int of_part, int piece, int) {
        if (share[piece] == SkinShare::none) share[piece] = SkinShare::own;
        if (of_part == kSeveral) share[piece] = SkinShare::joined;
    });
    return share;
}

}  // namespace swage
