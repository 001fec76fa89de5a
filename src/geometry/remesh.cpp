// SPDX-License-Identifier: GPL-3.0-or-later
// Source: M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling", 2004:
// split long edges, collapse short ones, flip towards six triangles a position, move positions
// along the surface; again.
#include "geometry/remesh.h"

#include <algorithm>

#include "base/error.h"
#include "base/portable_math.h"
#include "geometry/edges.h"

namespace swage {

namespace {

// Half-edge 3 t + k runs from corner k of triangle t to the next corner.
class HalfEdges {
  public:
    HalfEdges(const TriMesh& mesh, const std::vector<bool>& keep) : position(mesh.position) {
        for (const Corners& t : mesh.triangle) from_.insert(from_.end(), t.begin(), t.end());
        opposite_.resize(from_.size());
        kept_.assign(from_.size(), false);
        fixed_.assign(position.size(), false);
        out_.assign(position.size(), -1);
        for (int h = 0; h < size(); ++h) out_[from_[h]] = h;
        for_each_edge(edge_uses(mesh.triangle, position.size()), [&](auto uses) {
            if (uses.size() != 2 || uses[0].forward == uses[1].forward)
                fail(ExitCode::mesh, "only a closed manifold surface can be remeshed");
            const int a = 3 * uses[0].triangle + uses[0].side;
            const int b = 3 * uses[1].triangle + uses[1].side;
            const bool kept = !keep.empty() && (keep[a / 3] || keep[b / 3]);
            join(a, b, kept);
            if (kept) fixed_[uses[0].low] = fixed_[uses[0].high] = true;
        });
    }

    std::vector<Vec3> position;

    int size() const { return static_cast<int>(from_.size()); }
    bool alive(int h) const { return from_[h] >= 0; }
    bool used(int vertex) const { return out_[vertex] >= 0; }
    bool kept(int h) const { return kept_[h]; }
    bool fixed(int vertex) const { return fixed_[vertex]; }
    static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
    int opposite(int h) const { return opposite_[h]; }
    int from(int h) const { return from_[h]; }
    int to(int h) const { return from_[next(h)]; }
    int apex(int h) const { return from_[previous(h)]; }
    Vec3 area_vector(int h) const {
        const Vec3& a = position[from(h)];
        return (position[to(h)] - a).cross(position[apex(h)] - a);
    }

    // f(h) for the half-edges that leave a vertex.
    template <typename F>
    void around(int vertex, const F& f) const {
        int h = out_[vertex];
        do {
            f(h);
            h = opposite_[previous(h)];
        } while (h != out_[vertex]);
    }
    int valence(int vertex) const {
        int n = 0;
        around(vertex, [&](int) { ++n; });
        return n;
    }
    bool adjacent(int a, int b) const {
        bool found = false;
        around(a, [&](int h) { found = found || to(h) == b; });
        return found;
    }

    // Puts a new vertex on the edge.
    void split(int h, const Vec3& place) {
        const int m = static_cast<int>(position.size());
        position.push_back(place);
        const int o = opposite_[h];
        const int b = to(h);
        // h: a -> b, apex c, becomes a -> m, apex c; new triangle m -> b, apex c. So for o with d.
        const int hb = next(h), oa = previous(o);
        const int hb_outer = opposite_[hb], oa_outer = opposite_[oa];
        const int n = add_triangle(m, b, apex(h));
        const int q = add_triangle(b, m, apex(o));
        from_[hb] = m;
        from_[o] = m;
        join(n, q, false);
        join(n + 1, hb_outer, kept_[hb_outer]);
        join(n + 2, hb, false);
        join(q + 2, oa_outer, kept_[oa_outer]);
        join(q + 1, oa, false);
        fixed_.push_back(false);
        out_.push_back(n);
        out_[b] = q;
    }

    bool can_collapse(int h) const {
        const int o = opposite_[h];
        const int a = from(h), b = to(h), c = apex(h), d = apex(o);
        if (c == d || valence(c) <= 3 || valence(d) <= 3) return false;
        int shared = 0;
        around(a, [&](int x) { shared += to(x) != b && adjacent(to(x), b); });
        return shared == 2;
    }
    // Moves the start onto the end of the half-edge; both triangles vanish.
    void collapse(int h, const Vec3& place) {
        const int o = opposite_[h];
        const int a = from(h), b = to(h), c = apex(h), d = apex(o);
        std::vector<int> leaving;
        around(a, [&](int x) { leaving.push_back(x); });
        for (int x : leaving) from_[x] = b;
        position[b] = place;
        const int ca = opposite_[previous(h)], bc = opposite_[next(h)];
        const int ad = opposite_[next(o)], db = opposite_[previous(o)];
        join(ca, bc, kept_[ca] || kept_[bc]);
        join(ad, db, kept_[ad] || kept_[db]);
        // ca runs a -> c and starts at b now; bc runs c -> b; ad runs d -> a; db runs b -> d.
        out_[a] = -1;
        out_[b] = ca;
        out_[c] = bc;
        out_[d] = ad;
        for (int side : {h, o})
            for (int x : {side, next(side), previous(side)}) from_[x] = -1;
    }

    // Turns the edge a-b of the triangles (a, b, c), (b, a, d) into c-d.
    void flip(int h) {
        const int o = opposite_[h];
        const int a = from(h), b = to(h), c = apex(h), d = apex(o);
        const int bc = opposite_[next(h)], ad = opposite_[next(o)];
        const int ca = opposite_[previous(h)], db = opposite_[previous(o)];
        // h becomes d -> c with apex a, o becomes c -> d with apex b.
        from_[h] = d;
        from_[next(h)] = c;
        from_[previous(h)] = a;
        from_[o] = c;
        from_[next(o)] = d;
        from_[previous(o)] = b;
        join(next(h), ca, kept_[ca]);
        join(previous(h), ad, kept_[ad]);
        join(next(o), db, kept_[db]);
        join(previous(o), bc, kept_[bc]);
        out_[a] = previous(h);
        out_[b] = previous(o);
        out_[c] = o;
        out_[d] = h;
    }

    TriMesh mesh() const {
        TriMesh result;
        std::vector<int> number(position.size(), -1);
        for (std::size_t v = 0; v < position.size(); ++v)
            if (out_[v] >= 0) {
                number[v] = static_cast<int>(result.position.size());
                result.position.push_back(position[v]);
            }
        for (int h = 0; h < size(); h += 3)
            if (alive(h))
                result.triangle.push_back(
                    {number[from_[h]], number[from_[h + 1]], number[from_[h + 2]]});
        return result;
    }

  private:
    int add_triangle(int a, int b, int c) {
        const int h = size();
        from_.insert(from_.end(), {a, b, c});
        opposite_.resize(from_.size());
        kept_.resize(from_.size());
        return h;
    }
    void join(int a, int b, bool kept) {
        opposite_[a] = b;
        opposite_[b] = a;
        kept_[a] = kept_[b] = kept;
    }

    std::vector<int> from_, opposite_;
    std::vector<bool> kept_;   // of each half-edge and its opposite
    std::vector<bool> fixed_;  // of each vertex: at a kept edge
    std::vector<int> out_;     // of each vertex, one half-edge that leaves it; -1 for none
};

class Remesher {
  public:
    Remesher(const TriMesh& mesh, const RemeshSettings& settings)
        : edges_(mesh, settings.keep), settings_(settings) {}

    TriMesh run() {
        for (int round = 0; round < settings_.rounds; ++round) {
            split_long();
            collapse_short();
            flip_towards_six();
            relax();
        }
        return edges_.mesh();
    }

  private:
    static double least_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
        const auto at = [](const Vec3& p, const Vec3& q, const Vec3& r) {
            return portable::atan2((q - p).cross(r - p).norm(), (q - p).dot(r - p));
        };
        return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
    }

    // Length in units of the wanted length.
    double relative(const Vec3& a, const Vec3& b) const {
        return (b - a).norm() / settings_.edge_length(0.5 * (a + b));
    }
    double relative(int h) const {
        return relative(edges_.position[edges_.from(h)], edges_.position[edges_.to(h)]);
    }
    bool first_side(int h) const { return edges_.alive(h) && h < edges_.opposite(h); }

    void split_long() {
        const int count = edges_.size();
        for (int h = 0; h < count; ++h)
            if (first_side(h) && !edges_.kept(h) && relative(h) > 4.0 / 3)
                edges_.split(h, settings_.project(0.5 * (edges_.position[edges_.from(h)] +
                                                         edges_.position[edges_.to(h)])));
    }

    // No triangle around `vertex`, other than those with `other`, turns over or grows too large
    // when the vertex moves.
    bool may_move(int vertex, int other, const Vec3& place) const {
        bool may = true;
        edges_.around(vertex, [&](int h) {
            const Vec3 p = edges_.position[edges_.to(h)], q = edges_.position[edges_.apex(h)];
            if (edges_.to(h) == other || edges_.apex(h) == other) return;
            const Vec3 before = edges_.area_vector(h), after = (p - place).cross(q - place);
            may = may && relative(place, p) < 4.0 / 3 && relative(place, q) < 4.0 / 3 &&
                  before.dot(after) > 0.5 * before.norm() * after.norm();
        });
        return may;
    }

    void collapse_short() {
        for (int h = 0; h < edges_.size(); ++h) {
            if (!first_side(h) || edges_.kept(h) || relative(h) > 4.0 / 5 ||
                !edges_.can_collapse(h))
                continue;
            // A fixed end takes the other one in.
            const int side = edges_.fixed(edges_.from(h)) ? edges_.opposite(h) : h;
            const int a = edges_.from(side), b = edges_.to(side);
            if (edges_.fixed(a)) continue;
            const Vec3 place =
                edges_.fixed(b)
                    ? edges_.position[b]
                    : settings_.project(0.5 * (edges_.position[a] + edges_.position[b]));
            if (may_move(a, b, place) && may_move(b, a, place)) edges_.collapse(side, place);
        }
    }

    void flip_towards_six() {
        for (int h = 0; h < edges_.size(); ++h) {
            if (!first_side(h) || edges_.kept(h)) continue;
            const int o = edges_.opposite(h);
            const int a = edges_.from(h), b = edges_.to(h);
            const int c = edges_.apex(h), d = edges_.apex(o);
            const auto miss = [&](int vertex, int change) {
                const int off = edges_.valence(vertex) + change - 6;
                return off * off;
            };
            // Beside kept edges there is no right number of triangles; angles decide.
            const auto& p = edges_.position;
            const bool beside =
                edges_.fixed(a) || edges_.fixed(b) || edges_.fixed(c) || edges_.fixed(d);
            if (beside ? std::min(least_angle(p[d], p[c], p[a]), least_angle(p[c], p[d], p[b])) <=
                             std::min(least_angle(p[a], p[b], p[c]), least_angle(p[b], p[a], p[d]))
                       : miss(a, -1) + miss(b, -1) + miss(c, 1) + miss(d, 1) >=
                             miss(a, 0) + miss(b, 0) + miss(c, 0) + miss(d, 0))
                continue;
            if (edges_.valence(a) <= 3 || edges_.valence(b) <= 3 || edges_.adjacent(c, d)) continue;
            const Vec3 old =
                (edges_.area_vector(h).normalized() + edges_.area_vector(o).normalized())
                    .normalized();
            const Vec3 first = (p[c] - p[d]).cross(p[a] - p[d]);
            const Vec3 second = (p[d] - p[c]).cross(p[b] - p[c]);
            if (first.dot(old) > 0.6 * first.norm() && second.dot(old) > 0.6 * second.norm())
                edges_.flip(h);
        }
    }

    // Moves each position towards the mean of the centroids around it, weighted by their area in
    // units of the wanted one, along the surface.
    void relax() {
        const std::vector<Vec3> old = edges_.position;
        for (std::size_t v = 0; v < old.size(); ++v) {
            const int vertex = static_cast<int>(v);
            if (!edges_.used(vertex) || edges_.fixed(vertex)) continue;
            Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
            double weight = 0;
            edges_.around(vertex, [&](int h) {
                const Vec3 &p = old[edges_.to(h)], &q = old[edges_.apex(h)];
                const Vec3 area = (p - old[v]).cross(q - old[v]);
                const Vec3 centroid = (old[v] + p + q) / 3;
                const double wanted = settings_.edge_length(centroid);
                const double w = area.norm() / (wanted * wanted);
                normal += area;
                sum += w * centroid;
                weight += w;
            });
            if (!(weight > 0)) continue;
            normal.normalize();
            const Vec3 shift = sum / weight - old[v];
            edges_.position[v] = settings_.project(old[v] + shift - normal * normal.dot(shift));
        }
    }

    HalfEdges edges_;
    const RemeshSettings& settings_;
};

}  // namespace

TriMesh remesh(const TriMesh& mesh, const RemeshSettings& settings) {
    return Remesher(mesh, settings).run();
}

}  // namespace swage
