// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: S1.12. The paper marks the voxels that particles meet, keeps those with an unmarked
// neighbour, and joins every three particles that adjoin. NOTE: on a lattice that rule lays four
// triangles over each square; the faces between marked and unmarked voxels carry the same
// particles and are a closed surface.
#include "skin/voxel_surface.h"

#include <algorithm>

#include "geometry/disjoint_sets.h"
#include "skin/voxel_thinning.h"

namespace swage {

namespace {

struct Voxel {
    CellId cell;  // -1: none
    int corner;
};

class Builder {
  public:
    Builder(const Aggregate& matter, const SurfaceSamples& samples) : matter_(matter) {
        surface_.kept = voxels_to_draw(matter, samples);
    }

    VoxelSurface build() {
        find_neighbors();
        collect_faces();
        number_points();
        number_vertices();
        part_edges();
        choose_diagonals();
        return std::move(surface_);
    }

  private:
    static constexpr int axis_of(int direction) { return direction % 3; }
    static constexpr int opposite(int direction) { return (direction + 3) % 6; }

    void find_neighbors() {
        const Lattice& lattice = matter_.lattice;
        next_.resize(surface_.kept.size());
        corner_.resize(surface_.kept.size());
        for (const CellRun& run : lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                const CellId cell = run.first + n;
                const int i = run.i + n;
                next_[cell] = {
                    n + 1 < run.count ? cell + 1 : -1,    lattice.cell_at(i, run.j + 1, run.k),
                    lattice.cell_at(i, run.j, run.k + 1), n > 0 ? cell - 1 : -1,
                    lattice.cell_at(i, run.j - 1, run.k), lattice.cell_at(i, run.j, run.k - 1)};
                for (int c = 0; c < 8; ++c) corner_[cell][c] = run.corner(n, c);
            }
        }
    }

    bool is_kept(const Voxel& v) const {
        return v.cell >= 0 && surface_.kept[v.cell] >> v.corner & 1;
    }
    Voxel neighbor(const Voxel& v, int direction) const {
        const int bit = 1 << axis_of(direction);
        const bool leaves = (direction < 3) == ((v.corner & bit) != 0);
        const Voxel next{leaves ? next_[v.cell][direction] : v.cell, v.corner ^ bit};
        return is_kept(next) ? next : Voxel{-1, 0};
    }
    // Both exist, and hang together: the same particle, or two with a connection.
    bool joined(const Voxel& v, int direction) const {
        const Voxel other = neighbor(v, direction);
        if (other.cell < 0) return false;
        if (other.cell != v.cell) return true;
        const int axis = axis_of(direction);
        const int low = v.corner & ~(1 << axis);
        return matter_.connection[axis].weight[corner_[v.cell][low]] > 0;
    }

    int& face_at(const Voxel& v, int direction) {
        return block_[cell_block_[v.cell]][6 * v.corner + direction];
    }

    void collect_faces() {
        cell_block_.assign(next_.size(), -1);
        std::array<int, 48> none;
        none.fill(-1);
        for (const CellRun& run : matter_.lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                const CellId cell = run.first + n;
                const HalfSite low = {2 * (run.i + n), 2 * run.j, 2 * run.k};
                for (int corner = 0; corner < 8; ++corner) {
                    const Voxel voxel{cell, corner};
                    if (!is_kept(voxel)) continue;
                    for (int direction = 0; direction < 6; ++direction) {
                        if (joined(voxel, direction)) continue;
                        if (cell_block_[cell] < 0) {
                            cell_block_[cell] = static_cast<int>(block_.size());
                            block_.push_back(none);
                        }
                        face_at(voxel, direction) = static_cast<int>(surface_.face.size());
                        add_face(voxel, direction, low);
                    }
                }
            }
        }
    }

    void add_face(const Voxel& voxel, int direction, const HalfSite& cell_low) {
        const int axis = axis_of(direction), u = (axis + 1) % 3, v = (axis + 2) % 3;
        HalfSite low = cell_low;
        for (int d = 0; d < 3; ++d) low[d] += voxel.corner >> d & 1;
        if (direction < 3) ++low[axis];
        std::array<HalfSite, 4> site = {low, low, low, low};
        ++site[1][u], ++site[2][u], ++site[2][v], ++site[3][v];
        if (direction >= 3) std::swap(site[1], site[3]);
        surface_.face.push_back(
            {voxel.cell, voxel.corner, direction, neighbor(voxel, direction).cell >= 0, {}, {}});
        face_site_.push_back(site);
    }

    void number_points() {
        std::vector<std::pair<HalfSite, int>> all;
        for (std::size_t f = 0; f < face_site_.size(); ++f) {
            for (int k = 0; k < 4; ++k) {
                all.emplace_back(face_site_[f][k], static_cast<int>(4 * f + k));
            }
        }
        std::sort(all.begin(), all.end());
        for (std::size_t n = 0; n < all.size(); ++n) {
            if (n == 0 || all[n].first != all[n - 1].first) surface_.site.push_back(all[n].first);
            surface_.face[all[n].second / 4].point[all[n].second % 4] =
                static_cast<int>(surface_.site.size()) - 1;
        }
    }

    // The face that goes on across a face's edge, in direction `across`, on the same side of the
    // matter: around the edge from voxel to voxel as long as they hang together.
    int face_beyond(const VoxelFace& face, int across) {
        const Voxel v{face.cell, face.corner};
        const int n = face.direction;
        if (!joined(v, across)) return face_at(v, across);
        const Voxel a = neighbor(v, across);
        if (!joined(a, n)) return face_at(a, n);
        const Voxel b = neighbor(a, n);
        if (!joined(b, opposite(across))) return face_at(b, opposite(across));
        return face_at(neighbor(b, opposite(across)), opposite(n));
    }

    void number_vertices() {
        DisjointSets corners(4 * surface_.face.size());
        for (std::size_t f = 0; f < surface_.face.size(); ++f) {
            const VoxelFace& face = surface_.face[f];
            for (int k = 0; k < 4; ++k) {
                const int from = face.point[k], to = face.point[(k + 1) % 4];
                const VoxelFace& other = surface_.face[face_beyond(face, across_edge(f, k))];
                const int g = static_cast<int>(&other - surface_.face.data());
                for (int m = 0; m < 4; ++m) {
                    const int self = static_cast<int>(4 * f);
                    if (other.point[m] == from) corners.unite(self + k, 4 * g + m);
                    if (other.point[m] == to) corners.unite(self + (k + 1) % 4, 4 * g + m);
                }
            }
        }
        std::vector<int> number;
        surface_.vertex_count = corners.number_sets(number);
        for (std::size_t f = 0; f < surface_.face.size(); ++f) {
            for (int k = 0; k < 4; ++k) surface_.face[f].vertex[k] = number[4 * f + k];
        }
    }

    // An edge of the surface: two faces, each with the edge's number there.
    struct Edge {
        std::pair<int, int> vertex;  // the lower one first
        int face, side, other, other_side;
    };

    void part_edges() {
        std::vector<Edge> edge = crowded_edges();
        std::stable_sort(edge.begin(), edge.end(),
                         [](const Edge& p, const Edge& q) { return p.vertex < q.vertex; });
        for (std::size_t n = 1; n < edge.size(); ++n) {
            const Edge& e = edge[n];
            if (e.vertex != edge[n - 1].vertex) continue;
            surface_.face[e.face].middle[e.side] = surface_.vertex_count;
            surface_.face[e.other].middle[e.other_side] = surface_.vertex_count;
            ++surface_.vertex_count;
        }
    }

    void choose_diagonals() {
        for (std::size_t f = 0; f < surface_.face.size(); ++f) {
            VoxelFace& face = surface_.face[f];
            if (!face.cut) continue;
            const Voxel beyond = neighbor({face.cell, face.corner}, face.direction);
            const int other = face_at(beyond, opposite(face.direction));
            const auto& there = surface_.face[other].vertex;
            const auto is_shared = [&](int k) {
                return std::find(there.begin(), there.end(), face.vertex[k]) != there.end();
            };
            const bool first = is_shared(0) && is_shared(2), second = is_shared(1) && is_shared(3);
            if (first && second) {
                face.diagonal = static_cast<int>(f) < other ? Diagonal::first : Diagonal::second;
            } else if (first || second) {
                face.diagonal = first ? Diagonal::second : Diagonal::first;
            }
        }
    }

    // Those at places where more than two faces meet, each once.
    std::vector<Edge> crowded_edges() {
        std::vector<int> faces(3 * surface_.site.size(), 0);  // at the edge up along each axis
        const auto place_of = [&](std::size_t f, int k) -> int& {
            const int from = surface_.face[f].point[k], to = surface_.face[f].point[(k + 1) % 4];
            int axis = 0;
            while (surface_.site[from][axis] == surface_.site[to][axis]) ++axis;
            return faces[3 * std::min(from, to) + axis];
        };
        for (std::size_t f = 0; f < surface_.face.size(); ++f) {
            for (int k = 0; k < 4; ++k) ++place_of(f, k);
        }
        std::vector<Edge> edge;
        for (std::size_t f = 0; f < surface_.face.size(); ++f) {
            const VoxelFace& face = surface_.face[f];
            for (int k = 0; k < 4; ++k) {
                if (place_of(f, k) <= 2) continue;
                const int other = face_beyond(face, across_edge(f, k)), own = static_cast<int>(f);
                if (other < own) continue;
                const auto& there = surface_.face[other].point;
                int m = 0;
                while (there[m] != face.point[(k + 1) % 4] || there[(m + 1) % 4] != face.point[k]) {
                    ++m;
                }
                edge.push_back(
                    {std::minmax(face.vertex[k], face.vertex[(k + 1) % 4]), own, k, other, m});
            }
        }
        return edge;
    }

    // Direction in the face's plane from its middle over the edge from corner k to the next.
    int across_edge(std::size_t f, int k) const {
        const auto& site = face_site_[f];
        const int axis = axis_of(surface_.face[f].direction);
        for (int d = 0; d < 3; ++d) {
            if (d == axis || site[k][d] != site[(k + 1) % 4][d]) continue;
            return site[k][d] > site[(k + 2) % 4][d] ? d : d + 3;
        }
        return -1;
    }

    const Aggregate& matter_;
    VoxelSurface surface_;
    std::vector<std::array<CellId, 6>> next_;  // neighbours of each cell, by direction
    std::vector<std::array<ParticleId, 8>> corner_;
    std::vector<std::array<HalfSite, 4>> face_site_;
    std::vector<int> cell_block_;             // -1: no face
    std::vector<std::array<int, 48>> block_;  // faces of a cell: 6 a voxel, -1 for none
};

}  // namespace

std::array<Corners, 2> halves_of(const std::array<int, 4>& corner, const std::vector<Vec3>& place,
                                 std::optional<Diagonal> diagonal) {
    const auto length = [&](int a, int b) {
        return (place[corner[a]] - place[corner[b]]).squaredNorm();
    };
    const bool is_first = diagonal ? *diagonal == Diagonal::first : length(0, 2) <= length(1, 3);
    if (is_first) return halves(corner);
    return halves({corner[1], corner[2], corner[3], corner[0]});
}

VoxelSurface voxel_surface(const Aggregate& matter, const SurfaceSamples& samples) {
    return Builder(matter, samples).build();
}

}  // namespace swage
