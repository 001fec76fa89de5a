// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_objects.h"

#include <fmt/format.h>

#include <algorithm>

#include "geometry/disjoint_sets.h"

namespace swage {

MeshObjects objects_of_pieces(const TriMesh& mesh, const std::vector<int>& piece,
                              const std::string& body) {
    const int count = piece.empty() ? 0 : 1 + *std::max_element(piece.begin(), piece.end());
    if (count < 2) return {};
    const auto part_of = [&](std::size_t t) {
        return mesh.triangle_part.empty() ? 0 : mesh.triangle_part[t];
    };
    // Parts that any piece has together are one solid.
    DisjointSets solid(std::max<std::size_t>(1, mesh.part_name.size()));
    std::vector<int> part(static_cast<std::size_t>(count), -1);  // of each piece one
    for (std::size_t t = 0; t < piece.size(); ++t) {
        int& own = part.at(piece[t]);
        if (own < 0) own = part_of(t);
        solid.unite(own, part_of(t));
    }
    std::vector<int> parts_in(mesh.part_name.size() + 1, 0), pieces_of(parts_in);
    for (std::size_t p = 0; p < mesh.part_name.size(); ++p) {
        ++parts_in[solid.root(static_cast<int>(p))];
    }
    for (const int p : part) ++pieces_of[solid.root(p)];
    if (*std::max_element(pieces_of.begin(), pieces_of.end()) < 2) return {};
    MeshObjects objects;
    objects.triangle = piece;
    std::vector<int> named(parts_in.size(), 0);
    for (const int p : part) {
        const int root = solid.root(p);
        const bool is_of_part = parts_in[root] == 1 && !mesh.part_name[p].empty();
        std::string name = is_of_part ? mesh.part_name[p] : body;
        if (pieces_of[root] > 1) name += fmt::format("_piece_{}", ++named[root]);
        objects.name.push_back(name);
    }
    return objects;
}

}  // namespace swage
