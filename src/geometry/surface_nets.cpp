// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: S. Gibson, "Constrained elastic surface nets", 1998 (positions: the mean of the
// crossings in a cell); G. Nielson, "Dual marching cubes", 2004 (one position for each sheet of
// the surface in a cell, not one a cell); R. Wenger, "Isosurfaces", 2013 (when two such sheets
// would share two edges, the face between the cells is resolved the other way).
#include "geometry/surface_nets.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "geometry/polygon.h"

namespace swage {

namespace {

// Corner c of a cell has x = bit 0, y = bit 1, z = bit 2. Edge 4 a + u + 2 v runs along axis a at
// u on axis a + 1 and v on axis a + 2. Face 2 a + s lies across axis a on its low or high side.
constexpr int edge_number(int axis, int u, int v) { return 4 * axis + u + 2 * v; }

constexpr int corner_number(int axis, int a, int u, int v) {
    return (a << axis) | (u << ((axis + 1) % 3)) | (v << ((axis + 2) % 3));
}

struct Face {
    std::array<int, 4> corner;  // around the face
    std::array<int, 4> edge;    // edge i between corners i and i + 1
};

Face make_face(int axis, int side) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Face face;
    face.corner = {corner_number(axis, side, 0, 0), corner_number(axis, side, 1, 0),
                   corner_number(axis, side, 1, 1), corner_number(axis, side, 0, 1)};
    // Along u the other two axes are (v, axis); along v they are (axis, u).
    face.edge = {edge_number(u, 0, side), edge_number(v, side, 1), edge_number(u, 1, side),
                 edge_number(v, side, 0)};
    return face;
}

const std::array<Face, 6>& faces() {
    static const std::array<Face, 6> all = {make_face(0, 0), make_face(0, 1), make_face(1, 0),
                                            make_face(1, 1), make_face(2, 0), make_face(2, 1)};
    return all;
}

// A cell that the surface crosses.
struct Cell {
    Vec3i at;        // its low corner's sample; may be -1
    int inside = 0;  // one bit a corner
    int joined = 0;  // one bit an ambiguous face: the inside corners are joined across it
    std::array<signed char, 12> sheet{};  // of each crossed edge; -1 elsewhere
    int sheet_count = 0;
    int first_position = 0;

    bool is_inside(int corner) const { return inside >> corner & 1; }
    bool ambiguous(int face) const {
        const auto& c = faces()[face].corner;
        return is_inside(c[0]) == is_inside(c[2]) && is_inside(c[1]) == is_inside(c[3]) &&
               is_inside(c[0]) != is_inside(c[1]);
    }
    // Both strokes of the surface across an ambiguous face belong to one sheet.
    bool doubled(int face) const {
        const auto& e = faces()[face].edge;
        return ambiguous(face) && sheet[e[0]] == sheet[e[1]] && sheet[e[1]] == sheet[e[2]];
    }
    void find_sheets();
};

void Cell::find_sheets() {
    std::array<int, 12> root;
    std::iota(root.begin(), root.end(), 0);
    const auto unite = [&](int a, int b) {
        const int low = std::min(root[a], root[b]), high = std::max(root[a], root[b]);
        for (int& r : root)
            if (r == high) r = low;
    };
    std::array<bool, 12> crossed{};
    for (int f = 0; f < 6; ++f) {
        const Face& face = faces()[f];
        // A stroke cuts off each run of corners on one side of the surface: on ambiguous faces
        // each inside corner alone, or each outside corner when the inside is joined.
        const bool cut_inside = !(joined >> f & 1);
        std::array<int, 4> cut;
        int cuts = 0;
        for (int i = 0; i < 4; ++i)
            if (is_inside(face.corner[i]) != is_inside(face.corner[(i + 1) % 4])) {
                crossed[face.edge[i]] = true;
                cut[cuts++] = face.edge[i];
            }
        if (cuts == 2) unite(cut[0], cut[1]);
        if (cuts == 4)
            for (int i = 0; i < 4; ++i)
                if (is_inside(face.corner[i]) == cut_inside)
                    unite(face.edge[(i + 3) % 4], face.edge[i]);
    }
    sheet.fill(-1);
    sheet_count = 0;
    for (int e = 0; e < 12; ++e)
        if (crossed[e]) sheet[e] = root[e] == e ? sheet_count++ : sheet[root[e]];
}

class Nets {
  public:
    Nets(const ScalarGrid& grid, double iso) : grid_(grid), iso_(iso) {}

    TriMesh build() {
        find_cells();
        separate_doubled_faces();
        TriMesh mesh;
        place_positions(mesh);
        add_quads(mesh);
        return mesh;
    }

  private:
    double value(const Vec3i& p) const {
        if ((p.array() < 0).any() || (p.array() >= grid_.count.array()).any())
            return iso_ + grid_.spacing;
        return grid_.value[grid_.index(p.x(), p.y(), p.z())];
    }
    bool inside(const Vec3i& p) const { return value(p) < iso_; }

    int& cell_at(const Vec3i& at) {
        return cell_of_[(static_cast<std::size_t>(at.z() + 1) * (grid_.count.y() + 1) + at.y() +
                         1) *
                            (grid_.count.x() + 1) +
                        at.x() + 1];
    }

    void find_cells() {
        cell_of_.assign((grid_.count.cast<std::size_t>().array() + 1).prod(), -1);
        for (int k = -1; k < grid_.count.z(); ++k)
            for (int j = -1; j < grid_.count.y(); ++j)
                for (int i = -1; i < grid_.count.x(); ++i) {
                    Cell cell;
                    cell.at = {i, j, k};
                    for (int c = 0; c < 8; ++c)
                        if (inside(cell.at + corner_step(c))) cell.inside |= 1 << c;
                    if (cell.inside == 0 || cell.inside == 255) continue;
                    cell.find_sheets();
                    cell_at(cell.at) = static_cast<int>(cells_.size());
                    cells_.push_back(cell);
                }
    }

    // Two sheets that meet across both strokes of a face would share two edges between the same
    // two positions. Joining the inside there cuts both sheets in two; nothing is ever merged, so
    // one pass is enough.
    void separate_doubled_faces() {
        for (Cell& cell : cells_)
            for (int axis = 0; axis < 3; ++axis) {
                if (!cell.doubled(2 * axis + 1)) continue;
                Cell& next = cells_[cell_at(cell.at + Vec3i(Vec3i::Unit(axis)))];
                if (!next.doubled(2 * axis)) continue;
                cell.joined |= 1 << (2 * axis + 1);
                next.joined |= 1 << (2 * axis);
                cell.find_sheets();
                next.find_sheets();
            }
    }

    void place_positions(TriMesh& mesh) {
        for (Cell& cell : cells_) {
            cell.first_position = static_cast<int>(mesh.position.size());
            std::array<Vec3, 4> sum;
            std::array<int, 4> crossings{};
            sum.fill(Vec3::Zero());
            for (int e = 0; e < 12; ++e) {
                if (cell.sheet[e] < 0) continue;
                const int axis = e / 4;
                const Vec3i from = cell.at + e % 2 * Vec3i(Vec3i::Unit((axis + 1) % 3)) +
                                   e / 2 % 2 * Vec3i(Vec3i::Unit((axis + 2) % 3));
                const double low = value(from), high = value(from + Vec3i(Vec3i::Unit(axis)));
                Vec3 crossing = from.cast<double>();
                crossing[axis] += (iso_ - low) / (high - low);
                sum[cell.sheet[e]] += crossing;
                ++crossings[cell.sheet[e]];
            }
            for (int s = 0; s < cell.sheet_count; ++s)
                mesh.position.push_back(grid_.origin + grid_.spacing / crossings[s] * sum[s]);
        }
    }

    void add_quads(TriMesh& mesh) {
        int polygon = 0;
        for (const Cell& cell : cells_)
            for (int axis = 0; axis < 3; ++axis) {
                // The cell's edge at its low corner; each edge of the grid is that of one cell.
                const bool from = cell.is_inside(0), to = cell.is_inside(1 << axis);
                if (from == to) continue;
                const Vec3i u = Vec3i::Unit((axis + 1) % 3), v = Vec3i::Unit((axis + 2) % 3);
                const auto corner = [&](int du, int dv) {
                    const Cell& c = cells_[cell_at(cell.at - du * u - dv * v)];
                    return c.first_position + c.sheet[edge_number(axis, du, dv)];
                };
                std::array<int, 4> q = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
                if (to) std::swap(q[1], q[3]);
                const auto gap = [&](int a, int b) {
                    return (mesh.position[q[a]] - mesh.position[q[b]]).squaredNorm();
                };
                const Diagonal by = gap(0, 2) <= gap(1, 3) ? Diagonal::first : Diagonal::second;
                for (const Corners& half : halves(q, by)) mesh.triangle.push_back(half);
                mesh.triangle_polygon.insert(mesh.triangle_polygon.end(), 2, polygon++);
            }
    }

    const ScalarGrid& grid_;
    double iso_;
    std::vector<int> cell_of_;  // cells from -1 to count - 1 along each axis, x fastest
    std::vector<Cell> cells_;
};

}  // namespace

TriMesh surface_nets(const ScalarGrid& grid, double iso) {
    if ((grid.count.array() < 0).any() || !(grid.spacing > 0) ||
        grid.value.size() != grid.count.cast<std::size_t>().prod())
        fail(ExitCode::mesh, "a scalar grid of {} x {} x {} samples holds {} values",
             grid.count.x(), grid.count.y(), grid.count.z(), grid.value.size());
    return Nets(grid, iso).build();
}

}  // namespace swage
