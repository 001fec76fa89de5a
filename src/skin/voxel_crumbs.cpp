// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/voxel_crumbs.h"

#include <cmath>

#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

// Shells of the surface, by the sets of vertices that faces join.
std::vector<int> shells_of(const VoxelSurface& surface, int& count) {
    DisjointSets sets(surface.vertex_count);
    for (const VoxelFace& face : surface.face) {
        for (int k = 1; k < 4; ++k) sets.unite(face.vertex[0], face.vertex[k]);
    }
    std::vector<int> of_vertex, of_face;
    count = sets.number_sets(of_vertex);
    for (const VoxelFace& face : surface.face) of_face.push_back(of_vertex[face.vertex[0]]);
    return of_face;
}

void drop_faces(VoxelSurface& surface, const std::vector<char>& drop) {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < surface.face.size(); ++f) {
        if (!drop[f]) surface.face[kept++] = surface.face[f];
    }
    surface.face.resize(kept);
    std::vector<int> number(surface.vertex_count, -1);
    surface.vertex_count = 0;
    const auto renumber = [&](int& v) {
        if (v < 0) return;
        if (number[v] < 0) number[v] = surface.vertex_count++;
        v = number[v];
    };
    for (VoxelFace& face : surface.face) {
        for (int& v : face.vertex) renumber(v);
        for (int& v : face.middle) renumber(v);
    }
}

}  // namespace

void drop_crumbs(const Aggregate& matter, const Pieces& pieces, const std::vector<Vec3>& place,
                 VoxelSurface& surface) {
    constexpr double kCrumb = 0.02, kShell = 0.1;  // cells; a voxel is 0.125 before it is placed
    struct Shell {
        double volume = 0;
        int piece = -1;
        Vec3 origin;
        bool cut = false;
    };
    int count = 0;
    const std::vector<int> shell_of = shells_of(surface, count);
    if (count == 1) return;
    std::vector<Shell> shell(count);
    std::vector<double> volume(pieces.count, 0.0);
    for (std::size_t f = 0; f < surface.face.size(); ++f) {
        const VoxelFace& face = surface.face[f];
        Shell& own = shell[shell_of[f]];
        if (own.piece < 0) {
            own.piece = pieces.particle_piece[matter.lattice.cell_corners(face.cell)[face.corner]];
            own.origin = place[face.point[0]];
        }
        std::array<Vec3, 4> p;
        for (int k = 0; k < 4; ++k) p[k] = place[face.point[k]] - own.origin;
        own.volume += (p[0].dot(p[1].cross(p[2])) + p[0].dot(p[2].cross(p[3]))) / 6;
        own.cut |= face.cut;
    }
    std::vector<int> largest(pieces.count, -1);
    for (int s = 0; s < count; ++s) {
        int& most = largest[shell[s].piece];
        if (most < 0 || shell[s].volume > shell[most].volume) most = s;
        volume[shell[s].piece] += shell[s].volume;
    }
    const double cell = matter.lattice.cell_volume();
    const auto goes = [&](int s) {
        const Shell& own = shell[s];
        if (pieces.count > 1 && volume[own.piece] < kCrumb * cell) return true;
        return s != largest[own.piece] && !own.cut && std::abs(own.volume) < kShell * cell;
    };
    std::vector<char> drop(surface.face.size());
    for (std::size_t f = 0; f < drop.size(); ++f) drop[f] = goes(shell_of[f]);
    drop_faces(surface, drop);
}

}  // namespace swage
