// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/boundary.h"

#include <algorithm>
#include <limits>

#include "geometry/edge_attributes.h"
#include "skin/voxel_crossings.h"
#include "skin/voxel_place.h"
#include "skin/voxel_surface.h"

namespace swage {

namespace {

struct Owner {
    CellId cell = -1;
    int corner = 0;
    bool at_cut = false;
};

// A cell, and what of it hangs together.
struct Near {
    CellId cell;
    Vec3i site;
    std::array<ParticleId, 8> corner;
    CornerGroups group;
};

std::vector<Near> cells_within(const Aggregate& matter, const Vec3i& low, const Vec3i& high) {
    std::vector<Near> cells;
    for (int k = low.z(); k <= high.z(); ++k) {
        for (int j = low.y(); j <= high.y(); ++j) {
            for (int i = low.x(); i <= high.x(); ++i) {
                const CellId cell = matter.lattice.cell_at(i, j, k);
                if (cell < 0) continue;
                const auto corner = matter.lattice.cell_corners(cell);
                cells.push_back({cell, {i, j, k}, corner, corner_groups(matter, corner)});
            }
        }
    }
    return cells;
}

bool is_in(const std::vector<ParticleId>& sorted, ParticleId p) {
    return std::binary_search(sorted.begin(), sorted.end(), p);
}

// Adds what these cells join to what is reached.
void reach_on(const std::vector<Near>& cells, std::vector<ParticleId>& reached) {
    std::vector<ParticleId> more = reached;
    for (const Near& near : cells) {
        for (int c = 0; c < 8; ++c) {
            if (!is_in(reached, near.corner[c])) continue;
            for (int d = 0; d < 8; ++d) {
                if (near.group[c] >> d & 1) more.push_back(near.corner[d]);
            }
        }
    }
    std::sort(more.begin(), more.end());
    more.erase(std::unique(more.begin(), more.end()), more.end());
    reached = std::move(more);
}

// The corners of a cell that hang together with a corner of another within the cells between both;
// none where nothing does, or more than one part.
CornerMask side_reached(const Aggregate& matter, CellId home, ParticleId from, CellId over) {
    const Vec3i a = matter.lattice.cell_site(home), b = matter.lattice.cell_site(over);
    if (((a - b).array().abs() > 2).any()) return 0;
    const std::vector<Near> cells = cells_within(matter, a.cwiseMin(b), a.cwiseMax(b));
    std::vector<ParticleId> reached{from};
    for (std::size_t before = 0; before != reached.size();) {
        before = reached.size();
        reach_on(cells, reached);
    }
    const auto corner = matter.lattice.cell_corners(over);
    const CornerGroups group = corner_groups(matter, corner);
    CornerMask side = 0;
    for (int c = 0; c < 8; ++c) {
        if (!is_in(reached, corner[c])) continue;
        if (side != 0 && side != group[c]) return 0;
        side = group[c];
    }
    return side;
}

// The firm and whole cell nearest to a place among the first that are met on the way from a
// particle, in three steps at most; -1: none. NOTE: what a severed cell has left on one side may be
// two particles that next to nothing holds.
CellId whole_cell_near(const Aggregate& matter, CellId home, ParticleId from, const Vec3& place) {
    constexpr int kSteps = 3;
    const Vec3i site = matter.lattice.cell_site(home), around = Vec3i::Constant(2);
    const std::vector<Near> cells = cells_within(matter, site - around, site + around);
    const Vec3 at = (place - matter.lattice.origin) / matter.lattice.spacing;
    std::vector<ParticleId> reached{from};
    for (int step = 0; step < kSteps; ++step) {
        CellId nearest = -1;
        double least = std::numeric_limits<double>::infinity();
        for (const Near& near : cells) {
            if (near.group[0] != kAllCorners || matter.cell_fill[near.cell] < kFirmFill ||
                std::none_of(near.corner.begin(), near.corner.end(),
                             [&](ParticleId p) { return is_in(reached, p); })) {
                continue;
            }
            const Vec3 low = near.site.cast<double>(), high = low + Vec3::Ones();
            const double d = (at - at.cwiseMax(low).cwiseMin(high)).squaredNorm();
            if (d < least) least = d, nearest = near.cell;
        }
        if (nearest >= 0) return nearest;
        reach_on(cells, reached);
    }
    return -1;
}

// The cell and the corners that a vertex follows: matter that hangs together with the particle
// behind it, where the vertex lies if it can be.
void bind_vertex(const Aggregate& matter, const Pieces& pieces, const Vec3& place,
                 const Owner& owner, CellId& cell, CornerMask& side) {
    const auto home = matter.lattice.cell_corners(owner.cell);
    const ParticleId behind = home[owner.corner];
    cell = carrying_cell(matter, place);
    const auto corner = matter.lattice.cell_corners(cell);
    const auto at = std::find(corner.begin(), corner.end(), behind);
    side = at != corner.end() ? corner_groups(matter, corner)[at - corner.begin()]
                              : side_reached(matter, owner.cell, behind, cell);
    if (side != 0) return;
    side = kAllCorners;
    const bool is_own = pieces.particle_piece[corner[0]] == pieces.particle_piece[behind];
    if (!owner.at_cut && is_own && corners_hang_together(matter, corner)) return;
    cell = whole_cell_near(matter, owner.cell, behind, place);
    if (cell >= 0) return;
    cell = owner.cell;
    side = corner_groups(matter, home)[owner.corner];
}

// A little way into a voxel.
void into_voxel(const Aggregate& matter, const Owner& owner, Vec3& place) {
    constexpr double kApart = 0.02;  // spacings
    const CellBox box = cell_box(matter, owner.cell);
    const Vec3 half = corner_step(owner.corner).cast<double>();
    const Vec3 middle = Vec3::Constant(0.25) + 0.5 * half;  // of the voxel, in the cell
    const Vec3 way = box.low + middle.cwiseProduct(box.size) - place;
    const double far = way.norm();
    if (far > 0) place += kApart * matter.lattice.spacing / far * way;
}

// Where cells touch at an edge or a corner only, their surfaces have vertices of their own at one
// place. Each goes a little into its own voxel, for what reads a mesh may join what lies at one
// place. Not along a cut, which is closed until it opens.
void part_touching(const Aggregate& matter, const VoxelSurface& surface,
                   const std::vector<Owner>& owner, std::vector<Vec3>& reference) {
    std::vector<int> first(surface.site.size(), -1), point(reference.size(), -1);
    std::vector<char> shared(surface.site.size(), 0), cut(surface.site.size(), 0);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4; ++k) {
            const int p = face.point[k], v = face.vertex[k];
            point[v] = p;
            cut[p] |= face.cut;
            if (first[p] < 0) first[p] = v;
            shared[p] |= first[p] != v;
        }
    }
    for (std::size_t v = 0; v < reference.size(); ++v) {
        const int p = point[v];
        if (p < 0 || !shared[p] || cut[p]) continue;
        into_voxel(matter, owner[v], reference[v]);
    }
}

// By where the points are.
std::vector<Vec3> place_vertices(const Aggregate& matter, const VoxelSurface& surface,
                                 const std::vector<Owner>& owner, const std::vector<Vec3>& place) {
    std::vector<Vec3> vertex(surface.vertex_count);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4; ++k) vertex[face.vertex[k]] = place[face.point[k]];
    }
    part_touching(matter, surface, owner, vertex);
    std::vector<char> placed(vertex.size(), 0);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4; ++k) {
            const int v = face.middle[k];
            if (v < 0 || placed[v]) continue;
            placed[v] = 1;
            vertex[v] = 0.5 * (vertex[face.vertex[k]] + vertex[face.vertex[(k + 1) % 4]]);
            if (!owner[v].at_cut) into_voxel(matter, owner[v], vertex[v]);
        }
    }
    return vertex;
}

// Parts the triangles at the edges that have a vertex within.
void split_at_middles(const VoxelSurface& surface, TriMesh& mesh) {
    std::vector<std::pair<int, std::array<int, 3>>> split;  // triangle: two ends, and the middle
    for (std::size_t f = 0; f < surface.face.size(); ++f) {
        const VoxelFace& face = surface.face[f];
        for (int k = 0; k < 4; ++k) {
            if (face.middle[k] < 0) continue;
            const int from = face.vertex[k], to = face.vertex[(k + 1) % 4];
            for (int t : {static_cast<int>(2 * f), static_cast<int>(2 * f) + 1}) {
                const Corners& c = mesh.triangle[t];
                for (int side = 0; side < 3; ++side) {
                    if (c[side] != from || c[(side + 1) % 3] != to) continue;
                    split.push_back({t, {from, to, face.middle[k]}});
                }
            }
        }
    }
    if (split.empty()) return;
    const TriMesh whole = mesh;
    const auto clear = [](auto& array) { array.clear(); };
    for_each_triangle_array(clear, mesh);
    EdgeAttributes attributes(mesh);
    const auto copy = [](std::size_t t) {
        return [t](auto& array, const auto& from) {
            if (!from.empty()) array.push_back(from[t]);
        };
    };
    auto next = split.begin();
    for (std::size_t t = 0; t < whole.triangle.size(); ++t) {
        const std::size_t first = mesh.triangle.size();
        for_each_triangle_array(copy(t), mesh, whole);
        for (; next != split.end() && next->first == static_cast<int>(t); ++next) {
            const auto& [from, to, middle] = next->second;
            for (std::size_t n = first, end = mesh.triangle.size(); n < end; ++n) {
                for (int k = 0; k < 3; ++k) {
                    const int m = (k + 1) % 3;
                    if (mesh.triangle[n][k] != from || mesh.triangle[n][m] != to) continue;
                    for_each_triangle_array(copy(t), mesh, whole);
                    mesh.triangle.back() = mesh.triangle[n];
                    mesh.triangle.back()[k] = mesh.triangle[n][m] = middle;
                    if (mesh.triangle_uv.empty()) continue;
                    const Corners uv = mesh.triangle_uv[n];
                    mesh.triangle_uv.back() = uv;
                    const int at =
                        attributes.uv(middle, std::min(uv[k], uv[m]), std::max(uv[k], uv[m]), 0.5);
                    mesh.triangle_uv.back()[k] = mesh.triangle_uv[n][m] = at;
                }
            }
        }
    }
}

}  // namespace

BoundarySkin boundary_skin(const Aggregate& matter, const NewLook* look, double roughness) {
    const SurfaceSamples samples(matter);
    VoxelSurface surface = voxel_surface(matter, samples);
    const Pieces pieces = find_pieces(matter);
    const PointPlaces at =
        place_points(matter, pieces, samples, Warp(matter.lattice, roughness), surface);

    BoundarySkin skin;
    Mount& mount = skin.mount;
    mount.cell.resize(surface.vertex_count);
    mount.side.resize(surface.vertex_count);
    std::vector<Owner> owner(surface.vertex_count);
    for (const VoxelFace& face : surface.face) {
        const auto own = [&](int v) {
            if (v < 0) return;
            if (owner[v].cell < 0) owner[v].cell = face.cell, owner[v].corner = face.corner;
            owner[v].at_cut = owner[v].at_cut || face.cut;
        };
        for (int k = 0; k < 4; ++k) own(face.vertex[k]), own(face.middle[k]);
    }
    mount.reference = place_vertices(matter, surface, owner, at.place);
    std::vector<Facet> facet;
    for (const VoxelFace& face : surface.face)
        facet.push_back({face.vertex, face.middle, face.diagonal});
    std::vector<char> fixed(surface.vertex_count);
    for (int v = 0; v < surface.vertex_count; ++v) fixed[v] = owner[v].at_cut;
    for (const std::vector<Vec3>* rest : {&at.rest, &at.lattice}) {
        part_crossings(facet, place_vertices(matter, surface, owner, *rest), fixed,
                       matter.lattice.spacing, mount.reference);
    }
    for (int v = 0; v < surface.vertex_count; ++v) {
        bind_vertex(matter, pieces, mount.reference[v], owner[v], mount.cell[v], mount.side[v]);
    }
    finish_mount(mount, matter);

    TriMesh& mesh = skin.mesh;
    mesh.position = mount.reference;
    mesh.material.resize(2);
    mesh.material[0].name = "boundary";
    mesh.material[1].name = kCutMaterial;
    for (std::size_t f = 0; f < surface.face.size(); ++f) {
        for (const Corners& half :
             halves_of(surface.face[f].vertex, mount.reference, surface.face[f].diagonal)) {
            mesh.triangle.push_back(half);
            mesh.triangle_material.push_back(surface.face[f].cut);
            mesh.triangle_polygon.push_back(static_cast<int>(f));
        }
    }
    if (look != nullptr) look->paint(mount.reference, mesh);
    split_at_middles(surface, mesh);
    constexpr double kCrease = 0.7;  // [rad]
    smooth_by_crease_angle(mesh, kCrease);
    return skin;
}

}  // namespace swage
