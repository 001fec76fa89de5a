// SPDX-License-Identifier: GPL-3.0-or-later
// Plane by plane and triangle by triangle, each edge once for all who share it: so the parts fit
// whatever is rounded.
#include "skin/diced_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <unordered_map>

#include "geometry/edge_attributes.h"

namespace swage {

namespace {

using Segment = std::array<int, 2>;

// As a triangle of the mesh, with ids into its attributes.
struct Piece {
    Corners vertex, uv, smooth;
    int parent;
    Vec3i site;
};

class Dicer {
  public:
    Dicer(const TriMesh& mesh, const Lattice& lattice) : old_(mesh), lattice_(lattice) {
        edge_.assign(mesh.position.size(), {-1, -1});
        skin_.mesh = mesh;
        keep_smooth_normals(skin_.mesh);
        skin_.plane.assign(mesh.position.size(), {kNoPlane, kNoPlane, kNoPlane});
    }

    DicedSkin run(const std::function<bool(const Vec3i&)>& wanted) {
        std::vector<Piece> pieces;
        for (std::size_t t = 0; t < old_.triangle.size(); ++t) {
            const Corners none = {-1, -1, -1};
            pieces.push_back({old_.triangle[t],
                              old_.triangle_uv.empty() ? none : old_.triangle_uv[t],
                              old_.triangle_smooth.empty() ? none : old_.triangle_smooth[t],
                              static_cast<int>(t), Vec3i::Zero()});
        }
        for (int axis = 0; axis < 3; ++axis) {
            on_edge_.clear();
            std::vector<Piece> split;
            for (const Piece& piece : pieces) split_along(axis, piece, split);
            pieces = std::move(split);
        }
        pieces = leave_whole(pieces, wanted);
        drop_unused(pieces);
        finish(pieces);
        return std::move(skin_);
    }

  private:
    int lowest_plane(int axis, const Piece& piece) const {
        double low = std::numeric_limits<double>::infinity();
        for (int v : piece.vertex) low = std::min(low, skin_.mesh.position[v][axis]);
        int number =
            static_cast<int>(std::floor((low - lattice_.origin[axis]) / lattice_.spacing - 0.5)) -
            1;
        while (middle_plane(lattice_, axis, number) <= low) ++number;
        return number;
    }

    void split_along(int axis, const Piece& piece, std::vector<Piece>& out) {
        std::vector<Piece> upper = {piece};
        for (int number = lowest_plane(axis, piece); !upper.empty(); ++number) {
            const std::vector<Piece> all = std::move(upper);
            upper.clear();
            for (const Piece& one : all) split_at(axis, number, one, out, upper);
        }
    }

    // Parts below the plane to `lower`, with their site; those above to `upper`.
    void split_at(int axis, int number, Piece piece, std::vector<Piece>& lower,
                  std::vector<Piece>& upper) {
        const double height = middle_plane(lattice_, axis, number);
        std::array<int, 3> side;
        for (int k = 0; k < 3; ++k) {
            const int v = piece.vertex[k];
            side[k] = skin_.plane[v][axis] == number          ? 0
                      : skin_.mesh.position[v][axis] < height ? -1
                                                              : 1;
        }
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3;
            if (side[k] * side[next] >= 0) continue;
            // From the corner opposite to the crossed edge: two parts, each to be looked at again.
            Piece first = piece, second = piece;
            const int v = cross(axis, number, height, piece, k, next, first);
            first.vertex[next] = second.vertex[k] = v;
            second.uv[k] = first.uv[next];
            second.smooth[k] = first.smooth[next];
            split_at(axis, number, first, lower, upper);
            split_at(axis, number, second, lower, upper);
            return;
        }
        const bool is_upper = std::any_of(side.begin(), side.end(), [](int s) { return s > 0; });
        piece.site[axis] = number;
        (is_upper ? upper : lower).push_back(piece);
    }

    // The vertex where an edge meets the plane; its attributes go to corner `next` of `made`.
    int cross(int axis, int number, double height, const Piece& piece, int k, int next,
              Piece& made) {
        // From the lower number to the higher, whoever asks.
        const bool turned = piece.vertex[k] > piece.vertex[next];
        const int a = turned ? next : k, b = turned ? k : next;
        const int from = piece.vertex[a], to = piece.vertex[b];
        TriMesh& mesh = skin_.mesh;
        const double h0 = mesh.position[from][axis], h1 = mesh.position[to][axis];
        const double share = (height - h0) / (h1 - h0);
        const std::uint64_t key =
            static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
        const auto [entry, fresh] = on_edge_.emplace(key, static_cast<int>(mesh.position.size()));
        const int v = entry->second;
        if (fresh) {
            const Vec3 p = mesh.position[from], q = mesh.position[to];
            Vec3 at = p + share * (q - p);
            at[axis] = height;
            mesh.position.push_back(at);
            std::array<int, 3> plane = skin_.plane[from];
            for (int d = 0; d < 3; ++d) {
                if (skin_.plane[to][d] != plane[d]) plane[d] = kNoPlane;
                if (plane[d] != kNoPlane) mesh.position.back()[d] = p[d];
            }
            plane[axis] = number;
            skin_.plane.push_back(plane);
            edge_.push_back(old_edge(from, to));
            skin_.on_triangle.push_back(piece.parent);
            const Eigen::Vector3f color = attributes_.color(from, to, share);
            if (!mesh.position_color.empty()) mesh.position_color.push_back(color);
        }
        made.uv[next] = attributes_.uv(v, piece.uv[a], piece.uv[b], share);
        if (!old_.triangle_smooth.empty()) {
            made.smooth[next] = attributes_.smooth(v, piece.smooth[a], piece.smooth[b], share);
        }
        return v;
    }

    // The edge of the old mesh, low number first, on which both ends of an edge of a part lie.
    Segment old_edge(int from, int to) const {
        const int old = static_cast<int>(old_.position.size());
        if (from < old && to < old) return {from, to};
        const Segment other = edge_[to];  // the higher number is a new vertex
        const bool same = from < old ? from == other[0] || from == other[1] : edge_[from] == other;
        return same ? other : Segment{-1, -1};
    }

    // Puts triangles together again that have no part where any is wanted.
    std::vector<Piece> leave_whole(const std::vector<Piece>& pieces,
                                   const std::function<bool(const Vec3i&)>& wanted) {
        std::vector<char> is_diced(old_.triangle.size(), 0);
        for (const Piece& piece : pieces) {
            if (!is_diced[piece.parent] && wanted(piece.site)) is_diced[piece.parent] = 1;
        }
        const auto edge_at = [&](int t, int k) -> Segment {
            const auto [low, high] =
                std::minmax(old_.triangle[t][k], old_.triangle[t][(k + 1) % 3]);
            return {low, high};
        };
        std::map<Segment, std::vector<int>> on_edge;  // of diced triangles, from the low end on
        for (std::size_t t = 0; t < is_diced.size(); ++t) {
            for (int k = 0; k < 3 && is_diced[t]; ++k) on_edge[edge_at(static_cast<int>(t), k)];
        }
        for (std::size_t v = old_.position.size(); v < edge_.size(); ++v) {
            const auto at = on_edge.find(edge_[v]);
            if (at != on_edge.end()) at->second.push_back(static_cast<int>(v));
        }
        for (auto& [edge, points] : on_edge) {
            const Vec3 low = old_.position[edge[0]];
            std::sort(points.begin(), points.end(), [&](int a, int b) {
                const auto way = [&](int v) { return (skin_.mesh.position[v] - low).norm(); };
                return std::pair(way(a), a) < std::pair(way(b), b);
            });
        }
        std::vector<Piece> out;
        for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
            const int parent = pieces[begin].parent;
            while (end < pieces.size() && pieces[end].parent == parent) ++end;
            const auto parts = std::span(pieces).subspan(begin, end - begin);
            if (is_diced[parent]) {
                out.insert(out.end(), parts.begin(), parts.end());
                continue;
            }
            std::array<std::vector<int>, 3> side;
            for (int k = 0; k < 3; ++k) {
                const Segment edge = edge_at(parent, k);
                const auto at = on_edge.find(edge);
                if (at == on_edge.end()) continue;
                side[k] = at->second;
                if (edge[0] != old_.triangle[parent][k])
                    std::reverse(side[k].begin(), side[k].end());
            }
            fill(parts, old_.triangle[parent], side, out);
        }
        return out;
    }

    // Over a triangle with what lies on its sides, `side[k]` from corner k to the next.
    static void fill(std::span<const Piece> parts, const Corners& corner,
                     const std::array<std::vector<int>, 3>& side, std::vector<Piece>& out) {
        for (int k = 0; k < 3; ++k) {
            if (side[k].empty()) continue;
            const int next = (k + 1) % 3, last = (k + 2) % 3;
            const auto middle = side[k].begin() + static_cast<std::ptrdiff_t>(side[k].size() / 2);
            Corners first = corner, second = corner;
            first[next] = second[k] = *middle;
            std::array<std::vector<int>, 3> by_first, by_second;
            by_first[k].assign(side[k].begin(), middle);
            by_first[last] = side[last];
            by_second[k].assign(middle + 1, side[k].end());
            by_second[next] = side[next];
            fill(parts, first, by_first, out);
            fill(parts, second, by_second, out);
            return;
        }
        out.push_back(piece_of(parts, corner));
    }

    static Piece piece_of(std::span<const Piece> parts, const Corners& vertex) {
        Piece piece = parts.front();
        piece.vertex = vertex;
        piece.site = kNoSite;
        for (int k = 0; k < 3; ++k) {
            for (const Piece& part : parts) {
                for (int m = 0; m < 3; ++m) {
                    if (part.vertex[m] != vertex[k]) continue;
                    piece.uv[k] = part.uv[m];
                    piece.smooth[k] = part.smooth[m];
                }
            }
        }
        return piece;
    }

    // Takes out new vertices that only triangles had that were left whole.
    void drop_unused(std::vector<Piece>& pieces) {
        const std::size_t old = old_.position.size();
        std::vector<int> number(skin_.mesh.position.size(), -1);
        for (const Piece& piece : pieces) {
            for (int v : piece.vertex) number[v] = 0;
        }
        std::size_t count = 0;
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (v >= old && number[v] < 0) continue;
            number[v] = static_cast<int>(count);
            skin_.mesh.position[count] = skin_.mesh.position[v];
            skin_.plane[count] = skin_.plane[v];
            if (v >= old) skin_.on_triangle[count - old] = skin_.on_triangle[v - old];
            if (!skin_.mesh.position_color.empty()) {
                skin_.mesh.position_color[count] = skin_.mesh.position_color[v];
            }
            ++count;
        }
        skin_.mesh.position.resize(count);
        skin_.plane.resize(count);
        skin_.on_triangle.resize(count - old);
        if (!skin_.mesh.position_color.empty()) skin_.mesh.position_color.resize(count);
        for (Piece& piece : pieces) {
            for (int& v : piece.vertex) v = number[v];
        }
    }

    void finish(const std::vector<Piece>& pieces) {
        TriMesh& mesh = skin_.mesh;
        for_each_triangle_array([](auto& values) { values.clear(); }, mesh);
        int polygon = -1, last = -1;
        for (std::size_t n = 0; n < pieces.size(); ++n) {
            const Piece& piece = pieces[n];
            mesh.triangle.push_back(piece.vertex);
            skin_.site.push_back(piece.site);
            if (!old_.triangle_uv.empty()) mesh.triangle_uv.push_back(piece.uv);
            if (!old_.triangle_smooth.empty()) mesh.triangle_smooth.push_back(piece.smooth);
            if (!old_.triangle_material.empty()) {
                mesh.triangle_material.push_back(old_.triangle_material[piece.parent]);
            }
            if (!old_.triangle_part.empty()) {
                mesh.triangle_part.push_back(old_.triangle_part[piece.parent]);
            }
            if (!old_.triangle_polygon.empty()) {
                // Polygons stay together where none of their triangles was split.
                const bool whole = piece.vertex == old_.triangle[piece.parent];
                const int own = whole ? old_.triangle_polygon[piece.parent] : -1;
                if (own < 0 || own != last) ++polygon;
                last = own;
                mesh.triangle_polygon.push_back(polygon);
            }
        }
    }

    const TriMesh& old_;
    const Lattice& lattice_;
    DicedSkin skin_;
    EdgeAttributes attributes_{skin_.mesh};
    std::vector<Segment> edge_;  // a vertex each: the old edge that it was made on, or -1, -1
    std::unordered_map<std::uint64_t, int> on_edge_;  // looked up only
};

}  // namespace

double middle_plane(const Lattice& lattice, int axis, int number) {
    constexpr std::array<double, 3> kOff = {-3.1e-5, -2.3e-5, -4.7e-5};
    return lattice.origin[axis] + lattice.spacing * (number + 0.5 + kOff[axis]);
}

DicedSkin dice_skin(const TriMesh& mesh, const Lattice& lattice,
                    const std::function<bool(const Vec3i&)>& wanted) {
    return Dicer(mesh, lattice).run(wanted);
}

}  // namespace swage
