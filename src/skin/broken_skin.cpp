// SPDX-License-Identifier: GPL-3.0-or-later
// Who is joined to whom around a vertex is told by its cubes alone, one around each particle: a
// copy of the vertex for each group of them that hangs together there. So the surface comes out
// closed, without edges of four faces, whatever the crack. A new face is a square between two
// cubes, as far as it is inside the mesh; it follows the mesh's edges on it, and goes round along
// its own rim from where these leave it to where they come in next (K. Weiler and P. Atherton,
// "Hidden surface removal using polygon area sorting", 1977).
#include "skin/broken_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "geometry/edges.h"
#include "geometry/polygon.h"
#include "geometry/triangle_tree.h"
#include "skin/new_look.h"
#include "skin/parted_skin.h"
#include "skin/section.h"
#include "skin/thick_triangles.h"
#include "skin/whole_parts.h"

namespace swage {

namespace {

constexpr double kSamePlace = 1e-3;  // of a square's side
constexpr int kParts = 3;            // of a rough square's side
constexpr double kFree = 0.5;        // spacings from the surface, beyond which it leads no point

int open_edges(const TriMesh& mesh) {
    int open = 0;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()),
                  [&](auto uses) { open += uses.size() % 2; });
    return open;
}

class Breaker {
  public:
    Breaker(const TriMesh& whole, const Mount& mount, const Aggregate& matter, double roughness,
            bool bounds_matter, std::vector<BrokenFace> faces)
        : whole_(whole),
          matter_(matter),
          bounds_matter_(bounds_matter),
          warp_(matter.lattice, roughness),
          parts_(warp_.is_none() ? 1 : kParts),
          faces_(std::move(faces)),
          skin_(whole, mount, matter, faces_, warp_) {}

    BrokenSkin run() {
        prepare_attributes();
        collect_rims();
        // First those that the surface crosses: they tell on which side of a cut corners lie.
        for (bool crossed : {true, false}) {
            for (std::size_t f = 0; f < faces_.size(); ++f) {
                if (rim_[f].empty() != crossed) close(faces_[f], rim_[f], part_[f]);
            }
        }
        skin_.part_touching_edges();
        const int open = open_edges(skin_.mesh);
        if (open > 0 && open_edges(whole_) == 0) result_.open_faces += open;
        result_.mesh = std::move(skin_.mesh);
        result_.mount = std::move(skin_.mount);
        finish_mount(result_.mount, matter_);
        return std::move(result_);
    }

  private:
    using Segment = std::array<int, 2>;
    using Face = BrokenFace;

    void prepare_attributes() {
        TriMesh& mesh = skin_.mesh;
        const std::size_t count = mesh.triangle.size();
        mesh.triangle_material.resize(count, 0);
        material_ = cut_material(mesh, whole_);
        polygon_ = mesh.triangle_polygon.empty() ? 0 : mesh.triangle_polygon.back() + 1;
    }

    // Of each broken face the edges of the surface that lie on it, the inside on the left as seen
    // from the upper cube.
    void collect_rims() {
        rim_.resize(faces_.size());
        part_.assign(faces_.size(), 0);
        const auto key = [](const Vec3i& site, int axis) {
            return std::array<int, 4>{site.x(), site.y(), site.z(), axis};
        };
        std::map<std::array<int, 4>, std::size_t> number;
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            number[key(faces_[f].site, faces_[f].axis)] = f;
        }
        const DicedSkin& diced = skin_.diced();
        for (std::size_t t = 0; t < diced.mesh.triangle.size(); ++t) {
            const Corners& c = diced.mesh.triangle[t];
            for (int axis = 0; axis < 3; ++axis) {
                if (skin_.joined(diced.site[t], axis)) continue;
                for (int k = 0; k < 3; ++k) {
                    const int from = c[k], to = c[(k + 1) % 3], at = diced.site[t][axis];
                    if (skin_.plane(from)[axis] != at || skin_.plane(to)[axis] != at) continue;
                    const std::size_t face = number.at(key(diced.site[t], axis));
                    rim_[face].push_back({to, from});
                    if (!diced.mesh.triangle_part.empty()) {
                        part_[face] = diced.mesh.triangle_part[t];
                    }
                }
            }
        }
    }

    // 0 at a cube's low plane, 1 at its high one.
    double along_side(int axis, int site, double place) const {
        const MiddlePlanes& planes = skin_.diced().planes;
        const double low = planes.at(axis, site - 1);
        return (place - low) / (planes.at(axis, site) - low);
    }
    Vec2 on_square(const Face& face, int v) const {
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
        const Vec3& p = skin_.straight(v);
        return {along_side(a, face.site[a], p[a]), along_side(b, face.site[b], p[b])};
    }

    // How far a vertex lies along the square's rim, counter-clockwise; nothing if it is inside.
    std::optional<double> along_rim(const Face& face, int v) const {
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
        const Vec2 at = on_square(face, v);
        if (skin_.plane(v)[b] == face.site[b] - 1) return at[0];
        if (skin_.plane(v)[a] == face.site[a]) return 1 + at[1];
        if (skin_.plane(v)[b] == face.site[b]) return 3 - at[0];
        if (skin_.plane(v)[a] == face.site[a] - 1) return 4 - at[1];
        return std::nullopt;
    }

    // Points of squares are numbered along each axis: `parts_` from one plane to the next.
    Vec3i low_point(const Face& face) const {
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
        Vec3i point = parts_ * face.site;
        point[a] -= parts_, point[b] -= parts_;
        return point;
    }
    // On the rim, counter-clockwise from the low one.
    Vec3i rim_point(const Face& face, int n) const {
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
        const int side = n / parts_ % 4, on = n % parts_;
        Vec3i point = low_point(face);
        point[a] += side == 0 ? on : side == 1 ? parts_ : side == 2 ? parts_ - on : 0;
        point[b] += side == 0 ? 0 : side == 1 ? on : side == 2 ? parts_ : parts_ - on;
        return point;
    }
    // One that lies inside the mesh. `beside`: a vertex next to it along the rim, or -1.
    int vertex_at(const Vec3i& point, int beside) {
        const auto [known, fresh] = point_.emplace(std::array{point[0], point[1], point[2]}, -1);
        if (!fresh) return known->second;
        PartedSkin::Place place;
        for (int d = 0; d < 3; ++d) {
            const int number = floor_ratio(point[d]), on = point[d] - parts_ * number;
            const MiddlePlanes& planes = skin_.diced().planes;
            const double low = planes.at(d, number);
            place.plane[d] = on == 0 ? number : kNoPlane;
            place.straight[d] =
                on == 0 ? low : low + on * (planes.at(d, number + 1) - low) / parts_;
        }
        return known->second = add_vertex(place, point, beside);
    }
    int floor_ratio(int point) const {
        return point >= 0 ? point / parts_ : -((parts_ - 1 - point) / parts_);
    }

    // `point`: any three numbers that tell it.
    int add_vertex(PartedSkin::Place& place, const Vec3i& point, int beside) {
        place.at_molding = place_inside(place.straight, point);
        return skin_.add_vertex(place, Eigen::Vector3f::Ones(), beside);
    }

    // At molding. Near the surface, whose faces follow the warp as well as flat ones can, it is as
    // far off these as in straight space.
    Vec3 place_inside(const Vec3& straight, const Vec3i& point) {
        if (warp_.is_none()) return straight;
        const Vec3 free = warp_.rough(straight) + warp_.grain(point);
        const TriMesh& surface = skin_.diced().straight_mesh;
        const TriangleTree::Nearest nearest = tree().nearest(straight);
        Vec3 on = Vec3::Zero(), off = straight;
        for (int k = 0; k < 3; ++k) {
            const int v = surface.triangle[nearest.triangle][k];
            on += nearest.weight[k] * skin_.diced().position[v];
            off -= nearest.weight[k] * surface.position[v];
        }
        const double share = std::min(1.0, off.norm() / (kFree * warp_.spacing()));
        return on + off + share * (free - (on + off));
    }

    const TriangleTree& tree() {
        if (!tree_) tree_ = std::make_unique<TriangleTree>(skin_.diced().straight_mesh);
        return *tree_;
    }

    // `site`: of the cell in whose middle the place is, in straight space.
    bool is_inside(const Vec3& straight, const Vec3i& site) {
        const CellId cell = matter_.lattice.cell_at(site);
        if (bounds_matter_ && cell >= 0 && matter_.cell_fill[cell] > 0.9999f) return true;
        return tree().winding_number(straight) > 0.5;
    }

    // On a square's rim.
    struct Event {
        double at;
        int vertex, balance;  // 1: edges of the surface begin here, -1: end
    };
    // `needed`: only those that follow one of their own kind.
    static void order_pairs(std::vector<Event>& events, bool needed) {
        for (std::size_t n = 0; n + 1 < events.size(); ++n) {
            Event &one = events[n], &other = events[n + 1];
            if (one.balance > 0 || other.balance < 0 || other.at - one.at >= kSamePlace) continue;
            if (needed && events[n > 0 ? n - 1 : events.size() - 1].balance > 0) continue;
            std::swap(one, other);
            other.at = one.at;
        }
    }
    static bool alternates(const std::vector<Event>& events) {
        for (std::size_t n = 0; n < events.size(); ++n) {
            if (events[n].balance == events[(n + 1) % events.size()].balance) return false;
        }
        return true;
    }

    // The square's rim where it is inside the mesh; false where the surface does not close.
    bool go_round(const Face& face, std::vector<Segment>& segments) {
        std::map<int, int> balance;
        for (const Segment& s : segments) --balance[s[1]], ++balance[s[0]];
        std::vector<Event> events;
        for (const auto& [v, b] : balance) {
            if (b == 0) continue;
            const std::optional<double> at = along_rim(face, v);
            if (!at || std::abs(b) != 1) return false;
            events.push_back({*at, v, b});
        }
        std::sort(events.begin(), events.end(), [](const Event& p, const Event& q) {
            return std::pair(p.at, p.vertex) < std::pair(q.at, q.vertex);
        });
        // The two faces of a cut, or of a crack of old, meet the rim at nearly one place: there the
        // stretch of the rim that ends comes before the one that begins. NOTE: a stretch as short
        // as that must stay, which shows by what is beside it.
        const std::vector<Event> sorted = events;
        order_pairs(events, false);
        if (!alternates(events)) {
            events = sorted;
            order_pairs(events, true);
        }
        if (events.empty()) {
            const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
            const MiddlePlanes& planes = skin_.diced().planes;
            Vec3 low;
            low[face.axis] = planes.at(face.axis, face.site[face.axis]);
            low[a] = planes.at(a, face.site[a] - 1);
            low[b] = planes.at(b, face.site[b] - 1);
            Vec3i site;
            site[face.axis] = face.site[face.axis];
            site[a] = face.site[a] - 1, site[b] = face.site[b] - 1;
            if (!is_inside(low, site)) return true;
            int from = vertex_at(rim_point(face, 0), -1);
            for (int n = 1; n <= 4 * parts_; ++n) {
                const int to = vertex_at(rim_point(face, n), -1);
                segments.push_back({from, to});
                from = to;
            }
            return true;
        }
        if (!alternates(events)) return false;
        for (std::size_t n = 0; n < events.size(); ++n) {
            const Event& here = events[n];
            const Event& next = events[(n + 1) % events.size()];
            if (here.balance > 0) continue;
            int from = here.vertex;
            const double end = (next.at > here.at ? next.at : next.at + 4) * parts_;
            for (int k = static_cast<int>(std::floor(here.at * parts_)) + 1; k < end; ++k) {
                const int to = vertex_at(rim_point(face, k), from);
                segments.push_back({from, to});
                from = to;
            }
            segments.push_back({from, next.vertex});
        }
        return true;
    }

    // Of one loop by itself.
    void add_thick(const Face& face, const std::vector<int>& loop,
                   std::vector<Corners>& triangles) const {
        std::vector<Vec2> place;
        for (int v : loop) place.push_back(on_square(face, v));
        const auto at = [&](int k) { return Vec3(place[k][0], place[k][1], 0); };
        const auto upwards = [&](int a, int b, int c) {
            const bool is_up = (at(b) - at(a)).cross(at(c) - at(a)).z() > 0;
            return (is_up ? 1 : -1) * thickness(at(a), at(b), at(c));
        };
        for (const auto& [a, b, c] : thick_triangles(static_cast<int>(loop.size()), upwards)) {
            triangles.push_back({loop[a], loop[b], loop[c]});
        }
    }

    // Of a square that is inside the mesh as a whole, each part along its shorter diagonal.
    std::vector<Corners> fill_whole(const Face& face) {
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
        const Vec3i low = low_point(face);
        std::vector<Corners> triangles;
        for (int j = 0; j < parts_; ++j) {
            for (int i = 0; i < parts_; ++i) {
                std::array<int, 4> v;
                for (int k = 0; k < 4; ++k) {
                    Vec3i point = low;
                    point[a] += i + (k == 1 || k == 2), point[b] += j + (k > 1);
                    v[k] = vertex_at(point, -1);
                }
                const std::vector<Vec3>& p = skin_.mesh.position;
                const bool first = (p[v[2]] - p[v[0]]).norm() <= (p[v[3]] - p[v[1]]).norm();
                const auto both = halves(v, first ? Diagonal::first : Diagonal::second);
                triangles.insert(triangles.end(), both.begin(), both.end());
            }
        }
        return triangles;
    }

    // Triangles within closed loops; where the plane's own fill does not serve, each by itself.
    std::vector<Corners> fill(const Face& face, const std::vector<Segment>& segments) {
        Section section;
        section.spacing = parts_ == 1 ? 4 : 1.0 / parts_;  // 4: no points inside
        std::map<int, int> number;
        std::vector<int> vertex;
        for (const Segment& s : segments) {
            for (int v : s) {
                if (!number.emplace(v, static_cast<int>(vertex.size())).second) continue;
                vertex.push_back(v);
                section.point.push_back(on_square(face, v));
            }
            section.segment.push_back({number[s[0]], number[s[1]]});
        }
        std::vector<Corners> triangles;
        const std::optional<SectionTriangles> filled = fill_section(section);
        if (filled && (parts_ > 1 || filled->added.empty())) {
            for (const Vec2& at : filled->added) vertex.push_back(inner_vertex(face, at));
            for (const Corners& t : filled->triangle) {
                triangles.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
            }
            return triangles;
        }
        std::multimap<int, int> next;
        for (const Segment& s : segments) next.emplace(s[0], s[1]);
        while (!next.empty()) {
            const int start = next.begin()->first;
            std::vector<int> loop = {start, next.begin()->second};
            next.erase(next.begin());
            while (loop.back() != start) {
                const auto on = next.find(loop.back());
                if (on == next.end()) break;
                loop.push_back(on->second);
                next.erase(on);
            }
            if (loop.back() == start) loop.pop_back();
            add_thick(face, loop, triangles);
        }
        return triangles;
    }

    // Of a square that the surface does not cross: that of the surface nearest to it.
    int part_about(const Face& face) {
        Vec3 middle;
        for (int d = 0; d < 3; ++d) {
            const MiddlePlanes& planes = skin_.diced().planes;
            const double high = planes.at(d, face.site[d]);
            middle[d] = d == face.axis ? high : 0.5 * (planes.at(d, face.site[d] - 1) + high);
        }
        return skin_.diced().straight_mesh.triangle_part[tree().nearest(middle).triangle];
    }

    int inner_vertex(const Face& face, const Vec2& at) {
        const std::array<int, 2> side = {(face.axis + 1) % 3, (face.axis + 2) % 3};
        const MiddlePlanes& planes = skin_.diced().planes;
        PartedSkin::Place place;
        place.plane = {kNoPlane, kNoPlane, kNoPlane};
        place.plane[face.axis] = face.site[face.axis];
        place.straight[face.axis] = planes.at(face.axis, face.site[face.axis]);
        Vec3i point = low_point(face);
        for (int n = 0; n < 2; ++n) {
            const int d = side[n];
            const double low = planes.at(d, face.site[d] - 1);
            place.straight[d] = low + at[n] * (planes.at(d, face.site[d]) - low);
            point[d] += static_cast<int>(std::lround(at[n] * parts_));
        }
        return add_vertex(place, point, -1);
    }

    void close(const Face& face, std::vector<Segment>& segments, int part) {
        const bool is_within = segments.empty(), is_whole = parts_ > 1 && is_within;
        if (!go_round(face, segments)) {
            ++result_.open_faces;
            return;
        }
        if (segments.empty()) return;
        if (is_within && !whole_.triangle_part.empty()) part = part_about(face);
        Vec3i upper = face.site;
        ++upper[face.axis];
        for (const Corners& t : is_whole ? fill_whole(face) : fill(face, segments)) {
            add(face.site, face.axis, t, part);
            add(upper, 3 + face.axis, {t[0], t[2], t[1]}, part);
        }
    }

    // `way`: which of the six that it looks; faces are smooth among those that look the same, but
    // for rough ones, which have facets.
    void add(const Vec3i& site, int way, const Corners& raw, int part) {
        TriMesh& mesh = skin_.mesh;
        Corners own, smooth;
        for (int k = 0; k < 3; ++k) {
            own[k] = skin_.copy_of(raw[k], site);
            if (parts_ > 1) {
                smooth[k] = mesh.smooth_group_count;
                continue;
            }
            const auto [at, fresh] =
                smooth_.emplace(std::array{own[k], way}, mesh.smooth_group_count);
            mesh.smooth_group_count += fresh && !mesh.triangle_smooth.empty();
            smooth[k] = at->second;
        }
        mesh.smooth_group_count += parts_ > 1 && !mesh.triangle_smooth.empty();
        mesh.triangle.push_back(own);
        skin_.add_site(site);
        mesh.triangle_material.push_back(material_);
        if (!mesh.triangle_uv.empty()) mesh.triangle_uv.push_back({-1, -1, -1});
        if (!mesh.triangle_smooth.empty()) mesh.triangle_smooth.push_back(smooth);
        if (!mesh.triangle_polygon.empty()) mesh.triangle_polygon.push_back(polygon_++);
        if (!mesh.triangle_part.empty()) mesh.triangle_part.push_back(part);
        ++result_.faces;
    }

    const TriMesh& whole_;
    const Aggregate& matter_;
    const bool bounds_matter_;
    const Warp warp_;
    const int parts_;  // of a square's side
    const std::vector<Face> faces_;
    PartedSkin skin_;
    std::map<std::array<int, 3>, int> point_;   // vertices inside
    std::map<std::array<int, 2>, int> smooth_;  // of new faces, by vertex and way
    std::vector<std::vector<Segment>> rim_;
    std::vector<int> part_;  // of the mesh, at each broken face
    std::unique_ptr<TriangleTree> tree_;
    int material_ = 0, polygon_ = 0;
    BrokenSkin result_;
};

}  // namespace

bool is_broken(const Aggregate& matter) { return !broken_faces(matter).empty(); }

BrokenSkin break_skin(const TriMesh& whole, const Mount& mount, const Aggregate& matter,
                      double roughness, bool bounds_matter) {
    std::vector<BrokenFace> faces = faces_to_part(matter, mount);
    const auto broken_at = [&] {
        return Breaker(whole, mount, matter, roughness, bounds_matter, faces).run();
    };
    BrokenSkin broken = broken_at();
    if (!is_cut(mount) || follow_piece_beside(broken.mesh, broken.mount, matter)) return broken;
    part_around_mixed(matter, faces);
    broken = broken_at();
    follow_piece_beside(broken.mesh, broken.mount, matter);
    return broken;
}

}  // namespace swage
