// SPDX-License-Identifier: GPL-3.0-or-later
// Plane by plane and part by part, each edge once for all who share it: so the parts fit whatever
// is rounded.
#include "skin/diced_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>

#include "base/parallel.h"
#include "geometry/edge_attributes.h"
#include "skin/thick_triangles.h"

namespace swage {

namespace {

using Segment = std::array<int, 2>;

// Of what is made triangles of at once.
constexpr std::size_t kMostCorners = 40;
// Of edges where space is warped, in spacings: over shorter ones a warp is nearly straight.
constexpr double kLongest = 0.6;

// A convex part of a triangle of the mesh, without vertices but at its corners: lines that only a
// triangulation needs would be split too, and where they run close together so are slivers made.
struct Corner {
    int vertex, uv, smooth;  // ids into the mesh and its attributes
};
struct Piece {
    std::vector<Corner> corner;
    int parent;
    Vec3i site = Vec3i::Zero();
};

class Dicer {
  public:
    Dicer(const TriMesh& mesh, const Lattice& lattice, const Warp& warp)
        : old_(mesh), lattice_(lattice), warp_(warp) {
        edge_.assign(mesh.position.size(), {-1, -1});
        skin_.mesh = mesh;
        skin_.planes = MiddlePlanes(lattice);
        keep_smooth_normals(skin_.mesh);
        skin_.plane.assign(mesh.position.size(), {kNoPlane, kNoPlane, kNoPlane});
    }

    DicedSkin run(const std::function<bool(const Vec3i&)>& wanted) {
        std::vector<Piece> pieces;
        for (std::size_t t = 0; t < old_.triangle.size(); ++t) {
            Piece& piece = pieces.emplace_back(Piece{{}, static_cast<int>(t)});
            for (int k = 0; k < 3; ++k) {
                piece.corner.push_back(
                    {old_.triangle[t][k], old_.triangle_uv.empty() ? -1 : old_.triangle_uv[t][k],
                     old_.triangle_smooth.empty() ? -1 : old_.triangle_smooth[t][k]});
            }
        }
        if (!warp_.is_none()) pieces = divide(std::move(pieces));
        straighten(pieces);
        for (int axis = 0; axis < 3; ++axis) {
            on_edge_.clear();
            skin_.planes.choose(axis, skin_.straight, skin_.straight_mesh.triangle);
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
    // Into triangles with no edge above kLongest. Each edge is halved by its own length alone, so
    // that neighbours fit.
    std::vector<Piece> divide(std::vector<Piece> pieces) {
        std::vector<Piece> out;
        while (!pieces.empty()) {
            Piece piece = std::move(pieces.back());
            pieces.pop_back();
            const int k = longest_edge(piece);
            if (k < 0) {
                out.push_back(std::move(piece));
                continue;
            }
            const Corner &a = piece.corner[k], &b = piece.corner[(k + 1) % 3],
                         &c = piece.corner[(k + 2) % 3];
            const Corner middle =
                a.vertex < b.vertex ? halve(piece.parent, a, b) : halve(piece.parent, b, a);
            pieces.push_back({{a, middle, c}, piece.parent});
            pieces.push_back({{middle, b, c}, piece.parent});
        }
        std::stable_sort(out.begin(), out.end(),
                         [](const Piece& p, const Piece& q) { return p.parent < q.parent; });
        return out;
    }

    // The side of a triangle that is to be halved, or -1. Of sides that are as long as each other
    // the one farther along the axes: on both faces of a cut it is the same.
    int longest_edge(const Piece& piece) const {
        double longest = kLongest * lattice_.spacing;
        Vec3 middle = Vec3::Zero();
        int side = -1;
        for (int k = 0; k < 3; ++k) {
            const Vec3 &p = skin_.mesh.position[piece.corner[k].vertex],
                       &q = skin_.mesh.position[piece.corner[(k + 1) % 3].vertex];
            const double length = (q - p).norm();
            const Vec3 own = p + q;
            const bool is_farther =
                std::lexicographical_compare(middle.begin(), middle.end(), own.begin(), own.end());
            if (length < longest || (length == longest && (side < 0 || !is_farther))) continue;
            longest = length, middle = own, side = k;
        }
        return side;
    }

    Corner halve(int parent, const Corner& a, const Corner& b) {
        const int from = a.vertex, to = b.vertex;
        const auto [v, fresh] = vertex_on(from, to, parent, 0.5);
        if (fresh) {
            TriMesh& mesh = skin_.mesh;
            mesh.position.push_back(0.5 * (mesh.position[from] + mesh.position[to]));
            skin_.plane.push_back({kNoPlane, kNoPlane, kNoPlane});
        }
        return with_attributes(v, a, b, 0.5);
    }

    void straighten(const std::vector<Piece>& pieces) {
        constexpr std::size_t kPlaces = 256;
        const std::vector<Vec3>& position = skin_.mesh.position;
        skin_.straight.resize(position.size());
        parallel_each(position.size(), kPlaces,
                      [&](std::size_t v) { skin_.straight[v] = warp_.straight(position[v]); });
        skin_.position = position;
        skin_.straight_mesh.position = skin_.straight;
        for (const Piece& piece : pieces) {
            const auto& c = piece.corner;
            skin_.straight_mesh.triangle.push_back({c[0].vertex, c[1].vertex, c[2].vertex});
            if (old_.triangle_part.empty()) continue;
            skin_.straight_mesh.triangle_part.push_back(old_.triangle_part[piece.parent]);
        }
    }

    int lowest_plane(int axis, const Piece& piece) const {
        double low = std::numeric_limits<double>::infinity();
        for (const Corner& c : piece.corner) {
            low = std::min(low, skin_.straight[c.vertex][axis]);
        }
        int number =
            static_cast<int>(std::floor((low - lattice_.origin[axis]) / lattice_.spacing - 0.5)) -
            1;
        while (skin_.planes.at(axis, number) <= low) ++number;
        return number;
    }

    void split_along(int axis, Piece piece, std::vector<Piece>& out) {
        for (int number = lowest_plane(axis, piece); !piece.corner.empty(); ++number) {
            Piece lower = split_at(axis, number, piece);
            lower.site[axis] = number;
            if (!lower.corner.empty()) out.push_back(std::move(lower));
        }
    }

    // What lies below the plane; the rest stays.
    Piece split_at(int axis, int number, Piece& piece) {
        const double height = skin_.planes.at(axis, number);
        const auto is_upper = [&](const Corner& c) {
            return !(skin_.straight[c.vertex][axis] < height);
        };
        Piece lower{{}, piece.parent, piece.site}, upper = lower;
        for (std::size_t k = 0; k < piece.corner.size(); ++k) {
            const Corner &here = piece.corner[k],
                         &next = piece.corner[(k + 1) % piece.corner.size()];
            (is_upper(here) ? upper : lower).corner.push_back(here);
            if (is_upper(here) == is_upper(next)) continue;
            const Corner at = here.vertex < next.vertex
                                  ? cross(axis, number, height, piece.parent, here, next)
                                  : cross(axis, number, height, piece.parent, next, here);
            lower.corner.push_back(at);
            upper.corner.push_back(at);
        }
        piece = std::move(upper);
        return lower;
    }

    // Where an edge meets the plane; from the lower number to the higher, whoever asks.
    Corner cross(int axis, int number, double height, int parent, const Corner& a,
                 const Corner& b) {
        const int from = a.vertex, to = b.vertex;
        const double h0 = skin_.straight[from][axis], h1 = skin_.straight[to][axis];
        const double share = (height - h0) / (h1 - h0);
        const auto [v, fresh] = vertex_on(from, to, parent, share);
        if (fresh) {
            const auto between = [&](const std::vector<Vec3>& place) -> Vec3 {
                return place[from] + share * (place[to] - place[from]);
            };
            Vec3 at = between(skin_.straight);
            at[axis] = height;
            std::array<int, 3> plane = skin_.plane[from];
            for (int d = 0; d < 3; ++d) {
                if (skin_.plane[to][d] != plane[d]) plane[d] = kNoPlane;
                if (plane[d] != kNoPlane) at[d] = skin_.straight[from][d];
            }
            plane[axis] = number;
            skin_.plane.push_back(plane);
            skin_.straight.push_back(at);
            const Vec3 place = warp_.is_none() ? at : between(skin_.mesh.position);
            skin_.mesh.position.push_back(place);
        }
        return with_attributes(v, a, b, share);
    }

    // The new vertex on an edge, low number first, and whether it is not yet there.
    std::pair<int, bool> vertex_on(int from, int to, int parent, double share) {
        TriMesh& mesh = skin_.mesh;
        const std::uint64_t key =
            static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
        const auto [entry, fresh] = on_edge_.emplace(key, static_cast<int>(mesh.position.size()));
        if (fresh) {
            edge_.push_back(old_edge(from, to));
            skin_.on_triangle.push_back(parent);
            const Eigen::Vector3f color = attributes_.color(from, to, share);
            if (!mesh.position_color.empty()) mesh.position_color.push_back(color);
        }
        return {entry->second, fresh};
    }
    Corner with_attributes(int v, const Corner& a, const Corner& b, double share) {
        const bool is_smooth = !old_.triangle_smooth.empty();
        return {v, attributes_.uv(v, a.uv, b.uv, share),
                is_smooth ? attributes_.smooth(v, a.smooth, b.smooth, share) : -1};
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
        const std::size_t count = side[0].size() + side[1].size() + side[2].size();
        for (int k = 0; k < 3 && count > kMostCorners; ++k) {
            if (3 * side[k].size() < count) continue;
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
        std::vector<int> loop;
        for (int k = 0; k < 3; ++k) {
            loop.push_back(corner[k]);
            loop.insert(loop.end(), side[k].begin(), side[k].end());
        }
        out.push_back(piece_of(parts, loop));
    }

    static Piece piece_of(std::span<const Piece> parts, const std::vector<int>& vertex) {
        Piece piece{{}, parts.front().parent, kNoSite};
        for (int v : vertex) {
            Corner own{v, -1, -1};
            for (const Piece& part : parts) {
                for (const Corner& c : part.corner) {
                    if (c.vertex == v) own = c;
                }
            }
            piece.corner.push_back(own);
        }
        return piece;
    }

    // Takes out new vertices that only triangles had that were left whole.
    void drop_unused(std::vector<Piece>& pieces) {
        const std::size_t old = old_.position.size();
        std::vector<int> number(skin_.mesh.position.size(), -1);
        for (const Piece& piece : pieces) {
            for (const Corner& c : piece.corner) number[c.vertex] = 0;
        }
        std::size_t count = 0;
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (v >= old && number[v] < 0) continue;
            number[v] = static_cast<int>(count);
            skin_.mesh.position[count] = skin_.mesh.position[v];
            skin_.straight[count] = skin_.straight[v];
            skin_.plane[count] = skin_.plane[v];
            if (v >= old) skin_.on_triangle[count - old] = skin_.on_triangle[v - old];
            if (!skin_.mesh.position_color.empty()) {
                skin_.mesh.position_color[count] = skin_.mesh.position_color[v];
            }
            ++count;
        }
        skin_.mesh.position.resize(count);
        skin_.straight.resize(count);
        skin_.plane.resize(count);
        skin_.on_triangle.resize(count - old);
        if (!skin_.mesh.position_color.empty()) skin_.mesh.position_color.resize(count);
        for (Piece& piece : pieces) {
            for (Corner& c : piece.corner) c.vertex = number[c.vertex];
        }
    }

    void finish(const std::vector<Piece>& pieces) {
        TriMesh& mesh = skin_.mesh;
        for_each_triangle_array([](auto& values) { values.clear(); }, mesh);
        int polygon = -1, last = -1;
        for (const Piece& piece : pieces) {
            for (const Corners& corner : triangles_of(piece)) {
                add_triangle(piece, corner, polygon, last);
            }
        }
    }

    // `corner`: of the piece's. `polygon`: the number of the last, `last` that which it had.
    void add_triangle(const Piece& piece, const Corners& corner, int& polygon, int& last) {
        TriMesh& mesh = skin_.mesh;
        const auto three = [&](int Corner::*id) {
            return Corners{piece.corner[corner[0]].*id, piece.corner[corner[1]].*id,
                           piece.corner[corner[2]].*id};
        };
        const Corners vertex = three(&Corner::vertex);
        mesh.triangle.push_back(vertex);
        skin_.site.push_back(piece.site);
        if (!old_.triangle_uv.empty()) mesh.triangle_uv.push_back(three(&Corner::uv));
        if (!old_.triangle_smooth.empty()) mesh.triangle_smooth.push_back(three(&Corner::smooth));
        if (!old_.triangle_material.empty()) {
            mesh.triangle_material.push_back(old_.triangle_material[piece.parent]);
        }
        if (!old_.triangle_part.empty()) {
            mesh.triangle_part.push_back(old_.triangle_part[piece.parent]);
        }
        if (!old_.triangle_polygon.empty()) {
            // Polygons stay together where none of their triangles was split.
            const bool whole = vertex == old_.triangle[piece.parent];
            const int own = whole ? old_.triangle_polygon[piece.parent] : -1;
            if (own < 0 || own != last) ++polygon;
            last = own;
            mesh.triangle_polygon.push_back(polygon);
        }
    }

    // Corners of the piece, the thinnest triangle as thick as can be.
    std::vector<Corners> triangles_of(const Piece& piece) const {
        const int count = static_cast<int>(piece.corner.size());
        if (count == 3) return {{0, 1, 2}};
        const auto at = [&](int k) -> const Vec3& {
            return skin_.mesh.position[piece.corner[k].vertex];
        };
        return thick_triangles(count,
                               [&](int a, int b, int c) { return thickness(at(a), at(b), at(c)); });
    }

    const TriMesh& old_;
    const Lattice& lattice_;
    const Warp& warp_;
    DicedSkin skin_;
    EdgeAttributes attributes_{skin_.mesh};
    std::vector<Segment> edge_;  // a vertex each: the old edge that it was made on, or -1, -1
    std::unordered_map<std::uint64_t, int> on_edge_;  // looked up only
};

}  // namespace

DicedSkin dice_skin(const TriMesh& mesh, const Lattice& lattice, const Warp& warp,
                    const std::function<bool(const Vec3i&)>& wanted) {
    return Dicer(mesh, lattice, warp).run(wanted);
}

}  // namespace swage
