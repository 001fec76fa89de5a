// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/boundary.h"

#include <algorithm>
#include <cmath>

#include "skin/mount.h"
#include "skin/voxel_place.h"
#include "skin/voxel_surface.h"

namespace swage {

namespace {

struct Owner {
    CellId cell = -1;
    int corner = 0;
    bool at_cut = false;
};

// The cell and the corners that a vertex follows: matter that hangs together with the particle
// behind it.
void bind_vertex(const Aggregate& matter, const Vec3& place, const Owner& owner, CellId& cell,
                 CornerMask& side) {
    const auto home = matter.lattice.cell_corners(owner.cell);
    const CellId over = carrying_cell(matter, place);
    const auto corner = matter.lattice.cell_corners(over);
    const auto at = std::find(corner.begin(), corner.end(), home[owner.corner]);
    if (at != corner.end()) {
        cell = over;
        side = corner_groups(matter, corner)[at - corner.begin()];
    } else if (!owner.at_cut && is_whole(matter, corner)) {
        cell = over;
        side = kAllCorners;
    } else {
        cell = owner.cell;
        side = corner_groups(matter, home)[owner.corner];
    }
}

// A blade may cut off particles whose cells hold next to no material on that side. Such crumbs are
// not drawn: takes the faces out of all pieces that enclose less than a share of a cell.
void drop_crumbs(const Aggregate& matter, const std::vector<Vec3>& place, VoxelSurface& surface) {
    constexpr double kCrumb = 0.02;  // cells
    const Pieces pieces = find_pieces(matter);
    if (pieces.count == 1) return;
    const auto piece_of = [&](const VoxelFace& face) {
        return pieces.particle_piece[matter.lattice.cell_corners(face.cell)[face.corner]];
    };
    std::vector<double> volume(pieces.count, 0.0);
    std::vector<Vec3> origin(pieces.count, Vec3::Zero());
    std::vector<char> seen(pieces.count, 0);
    for (const VoxelFace& face : surface.face) {
        const int piece = piece_of(face);
        if (!seen[piece]) seen[piece] = 1, origin[piece] = place[face.point[0]];
        std::array<Vec3, 4> p;
        for (int k = 0; k < 4; ++k) p[k] = place[face.point[k]] - origin[piece];
        volume[piece] += (p[0].dot(p[1].cross(p[2])) + p[0].dot(p[2].cross(p[3]))) / 6;
    }
    const double least = kCrumb * std::pow(matter.lattice.spacing, 3);
    std::erase_if(surface.face,
                  [&](const VoxelFace& face) { return volume[piece_of(face)] < least; });
    std::vector<int> number(surface.vertex_count, -1);
    surface.vertex_count = 0;
    for (VoxelFace& face : surface.face) {
        for (int& v : face.vertex) {
            if (number[v] < 0) number[v] = surface.vertex_count++;
            v = number[v];
        }
    }
}

}  // namespace

TriMesh boundary_skin(const Aggregate& matter, const NewLook* look) {
    VoxelSurface surface = voxel_surface(matter);
    const std::vector<Vec3> place = place_points(matter, surface);
    drop_crumbs(matter, place, surface);

    Mount mount;
    mount.reference.resize(surface.vertex_count);
    mount.cell.resize(surface.vertex_count);
    mount.side.resize(surface.vertex_count);
    std::vector<Owner> owner(surface.vertex_count);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4; ++k) {
            Owner& own = owner[face.vertex[k]];
            if (own.cell < 0) own.cell = face.cell, own.corner = face.corner;
            own.at_cut = own.at_cut || face.cut;
            mount.reference[face.vertex[k]] = place[face.point[k]];
        }
    }
    for (int v = 0; v < surface.vertex_count; ++v) {
        bind_vertex(matter, mount.reference[v], owner[v], mount.cell[v], mount.side[v]);
    }
    finish_mount(mount, matter);

    TriMesh mesh;
    skin_positions(mount, matter, mesh.position);
    mesh.material.resize(2);
    mesh.material[0].name = "boundary";
    mesh.material[1].name = kCutMaterial;
    for (std::size_t f = 0; f < surface.face.size(); ++f) {
        const auto& v = surface.face[f].vertex;
        const auto length = [&](int a, int b) {
            return (mesh.position[v[a]] - mesh.position[v[b]]).squaredNorm();
        };
        if (length(0, 2) <= length(1, 3)) {
            mesh.triangle.push_back({v[0], v[1], v[2]});
            mesh.triangle.push_back({v[0], v[2], v[3]});
        } else {
            mesh.triangle.push_back({v[1], v[2], v[3]});
            mesh.triangle.push_back({v[1], v[3], v[0]});
        }
        for (int n = 0; n < 2; ++n) {
            mesh.triangle_material.push_back(surface.face[f].cut);
            mesh.triangle_polygon.push_back(static_cast<int>(f));
        }
    }
    if (look != nullptr) look->paint(mount.reference, mesh);
    constexpr double kCrease = 0.7;  // [rad]
    smooth_by_crease_angle(mesh, kCrease);
    return mesh;
}

}  // namespace swage
