// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_mesh.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include "geometry/box.h"
#include "geometry/disjoint_sets.h"
#include "geometry/mesh_edit.h"
#include "matter/cell_middle.h"
#include "skin/body_map.h"
#include "skin/cut_places.h"
#include "skin/halve_along.h"
#include "skin/piece_map.h"
#include "skin/split_attributes.h"
#include "skin/surface_split.h"

namespace swage {

namespace {

// A part that a cut leaves is a chip below one cell and this share of the mesh, and nowhere a cell
// away from the cut.
constexpr double kChipShare = 0.01;
// An edge that by the matter's map leaves its chord by more than this share of its length spans a
// jump of the map.
constexpr double kLeavesChord = 0.1;

// Spacings: the longest edge along a path that bends.
constexpr double kBentEdge = 0.5;

// A path, and the side of it that each vertex must follow; 0: as it likes.
struct SidedPath {
    BladePath path;
    std::vector<int> own = {};
};

// What blades that have severed nothing yet have cut.
struct CutSoFar {
    std::vector<SidedPath> path;
    std::vector<std::array<int, 2>> chip_link;  // vertices of chips, and of what they stay with
};

// One cut along one path.
class PathCut {
  public:
    PathCut(TriMesh& mesh, const std::vector<Vec3>& position, Mount& mount, const Aggregate& matter,
            const BladePath& path, const Insides& insides, CutSoFar& so_far)
        : mesh_(mesh),
          position_(position),
          mount_(mount),
          matter_(matter),
          path_(path),
          insides_(insides),
          so_far_(so_far),
          map_(matter),
          pieces_(matter) {}

    SurfaceSplit run() {
        const double a = matter_.lattice.spacing;
        // Seen along the plane's normal, which makes steep parts short.
        const double apart = path_.relief ? kBentEdge * a * std::min(1.0, 2 / path_.steepest) : a;
        SurfaceSplit split = split_surface(mesh_, position_, path_, apart, insides_);
        std::vector<int> own = sides_of_old(split);
        if (split.seam_edges == 0) {
            pass_by(std::move(own));
            return split;
        }
        const int old = static_cast<int>(mesh_.position.size());
        std::vector<BodyPlace> cut, inner;
        std::vector<double> share;
        std::vector<Vec3> cut_world;
        find_cut_places(split, cut, share, cut_world);
        draw_rim_straight(cut_world, split);
        find_cap_places(split, cut, inner);

        own.resize(old + split.added.size(), 0);
        std::vector<Vec3> reference;
        std::vector<Vec3> world = position_;
        for (std::size_t n = 0; n < split.added.size(); ++n) {
            const int raw = split.added[n].raw;
            own[old + n] = split.added[n].side;
            BodyPlace place;
            if (raw < old) {
                place = mount_.place(raw);
                world.push_back(position_[raw]);
            } else {
                const std::size_t at = raw - old;
                place = at < cut.size() ? cut[at] : inner[at - cut.size()];
                world.push_back(at < cut.size() ? cut_world[at] : split.cap_point[at - cut.size()]);
            }
            reference.push_back(place.reference);
            mount_.add(place);
        }
        leave_chips(split, world, own);
        for (SidedPath& other : so_far_.path) add_sides(split, world, other);
        so_far_.path.push_back({path_, std::move(own)});
        for (const SidedPath& one : so_far_.path) {
            // What was there keeps to those before this one already.
            const bool is_new = &one == &so_far_.path.back();
            for (int v = is_new ? 0 : old; v < static_cast<int>(world.size()); ++v) {
                take_side(v, one, world[v]);
            }
        }
        keep_smooth_normals(mesh_);
        mesh_ = apply_split(mesh_, split, reference, share, insides_);
        finish_mount(mount_, matter_);
        hold_places(mount_, matter_, world);
        return split;
    }

  private:
    // One that lies on the path, or nearly, is with its triangles. A part of the surface that is
    // not cut is all on one side, however near the path it lies; on both, as it likes.
    std::vector<int> sides_of_old(const SurfaceSplit& split) const {
        std::vector<char> above(position_.size(), 0), below(position_.size(), 0);
        for (const SplitTriangle& t : split.triangle) {
            for (const int raw : t.raw) {
                if (raw >= static_cast<int>(position_.size())) continue;
                if (t.side >= 0) above[raw] = 1;
                if (t.side <= 0) below[raw] = 1;
            }
        }
        std::vector<int> own;
        for (std::size_t v = 0; v < position_.size(); ++v) {
            own.push_back(path_.height(position_[v]) >= 0 ? 1 : -1);
            if (above[v] != below[v]) own[v] = above[v] ? 1 : -1;
        }
        const Components parts = surface_components(mesh_);
        std::vector<char> at_seam(mesh_.position.size(), 0);
        for (const SplitVertex& vertex : split.at_seam) at_seam[vertex.raw] = 1;
        std::vector<char> is_cut(parts.count, 0), over(parts.count, 0), under(parts.count, 0);
        for (const SplitTriangle& t : split.triangle) {
            if (t.parent < 0) continue;
            const int part = parts.triangle_component[t.parent];
            const Corners& c = mesh_.triangle[t.parent];
            if (t.split || at_seam[c[0]] || at_seam[c[1]] || at_seam[c[2]]) is_cut[part] = 1;
            if (t.side >= 0) over[part] = 1;
            if (t.side <= 0) under[part] = 1;
        }
        for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
            const int part = parts.triangle_component[t];
            for (const int v : mesh_.triangle[t]) {
                if (!is_cut[part]) own[v] = over[part] - under[part];
            }
        }
        for (const SplitVertex& vertex : split.at_seam) own[vertex.raw] = vertex.side;
        return own;
    }

    // The blade goes through a gap: it parts the matter of cells that reach across it, and what
    // lies on either side of it is to follow its own.
    void pass_by(std::vector<int> own) {
        so_far_.path.push_back({path_, std::move(own)});
        std::vector<Vec3> before;
        skin_positions(mount_, matter_, before);
        for (std::size_t v = 0; v < position_.size(); ++v) {
            take_side(static_cast<int>(v), so_far_.path.back(), position_[v]);
        }
        finish_mount(mount_, matter_);
        hold_places(mount_, matter_, before);
    }

    // What is cut off thinner than the matter knows would hang in the air beside what is not of it:
    // it stays where it was cut from.
    void leave_chips(const SurfaceSplit& split, const std::vector<Vec3>& world,
                     std::vector<int>& own) {
        DisjointSets sets(own.size());
        for (const SplitTriangle& t : split.triangle) {
            sets.unite(t.vertex[0], t.vertex[1]), sets.unite(t.vertex[0], t.vertex[2]);
        }
        drop_split_links(split);
        for (const auto& [chip, host] : so_far_.chip_link) sets.unite(chip, host);
        std::vector<int> part;
        std::vector<double> volume(sets.number_sets(part), 0.0);
        std::vector<char> is_cut(volume.size(), 0);
        double all = 0;
        for (const SplitTriangle& t : split.triangle) {
            const auto& [a, b, c] = t.vertex;
            const Vec3& from = path_.point;
            const double under =
                (world[a] - from).dot((world[b] - from).cross(world[c] - from)) / 6;
            volume[part[a]] += under;
            all += under;
            if (t.parent < 0) is_cut[part[a]] = 1;
        }
        const double least = std::min(matter_.lattice.cell_volume(), kChipShare * std::abs(all));
        std::vector<double> far(volume.size(), 0.0);
        for (std::size_t v = 0; v < own.size(); ++v) {
            far[part[v]] = std::max(far[part[v]], std::abs(path_.height(world[v])));
        }
        const auto is_chip = [&](int v) {
            return is_cut[part[v]] && std::abs(volume[part[v]]) < least &&
                   far[part[v]] < matter_.lattice.spacing;
        };
        link_chips(split, is_chip);
        for (std::size_t v = 0; v < own.size(); ++v) {
            if (is_chip(static_cast<int>(v))) own[v] = -own[v];
        }
    }

    // A vertex that this cut has split may be on either side of it.
    void drop_split_links(const SurfaceSplit& split) {
        std::set<int> at_seam;
        for (const SplitVertex& vertex : split.at_seam) at_seam.insert(vertex.raw);
        std::erase_if(so_far_.chip_link, [&](const auto& link) {
            return at_seam.contains(link[0]) || at_seam.contains(link[1]);
        });
    }

    template <typename IsChip>
    void link_chips(const SurfaceSplit& split, const IsChip& is_chip) {
        std::map<int, std::array<int, 2>> copy;  // of what is raw, below and above
        for (const SplitTriangle& t : split.triangle) {
            if (t.parent >= 0) continue;
            for (int k = 0; k < 3; ++k) {
                const auto at = copy.emplace(t.raw[k], std::array{-1, -1}).first;
                at->second[t.side > 0] = t.vertex[k];
            }
        }
        for (const auto& [raw, both] : copy) {
            const auto [below, above] = both;
            if (below < 0 || above < 0) continue;
            if (is_chip(below) != is_chip(above)) so_far_.chip_link.push_back({below, above});
        }
    }

    // Of what this cut adds, the sides of a path before it.
    void add_sides(const SurfaceSplit& split, const std::vector<Vec3>& world,
                   SidedPath& other) const {
        const auto old = static_cast<int>(other.own.size());
        for (std::size_t n = 0; n < split.added.size(); ++n) {
            const int raw = split.added[n].raw, at = raw - old;
            if (at < 0) {
                other.own.push_back(other.own[raw]);
            } else if (at < static_cast<int>(split.cut.size())) {
                const int low = other.own[split.cut[at].low], high = other.own[split.cut[at].high];
                other.own.push_back(low == high ? low : 0);
            } else {
                other.own.push_back(other.path.height(world[old + n]) >= 0 ? 1 : -1);
            }
        }
    }

    BodyPlace on_edge(const EdgeCut& cut, double share) const {
        const std::array<BodyPlace, 2> ends = {mount_.place(cut.low), mount_.place(cut.high)};
        return pieces_.beside(ends[0].reference + share * (ends[1].reference - ends[0].reference),
                              ends);
    }

    // Where each edge of the mesh, straight at molding and curved by now, meets the path. Regula
    // falsi, Illinois variant. `world`: where what is held is held; the chord's where the map
    // jumps.
    void find_cut_places(const SurfaceSplit& split, std::vector<BodyPlace>& places,
                         std::vector<double>& share, std::vector<Vec3>& world) const {
        for (const EdgeCut& cut : split.cut) {
            double s0 = 0, s1 = 1;
            double h0 = path_.height(position_[cut.low]), h1 = path_.height(position_[cut.high]);
            double s = cut.share;
            BodyPlace place = on_edge(cut, s);
            for (int round = 0; round < 30; ++round) {
                const double h = path_.height(map_.world(place));
                if (std::abs(h) <= 1e-9 * matter_.lattice.spacing || s1 - s0 < 1e-12) break;
                if ((h > 0) == (h1 > 0)) {
                    s1 = s, h1 = h, h0 *= 0.5;
                } else {
                    s0 = s, h0 = h, h1 *= 0.5;
                }
                s = s0 + (s1 - s0) * h0 / (h0 - h1);
                place = on_edge(cut, s);
            }
            Vec3 at = map_.world(place);
            const Vec3 &low = position_[cut.low], &high = position_[cut.high];
            const Vec3 chord = low + cut.share * (high - low);
            if ((at - chord).norm() > kLeavesChord * (high - low).norm()) at = chord;
            places.push_back(place);
            share.push_back(s);
            world.push_back(path_.world(path_.flat(at)));
        }
    }

    // Between the places of the cut points.
    void draw_rim_straight(const std::vector<Vec3>& cut_world, SurfaceSplit& split) const {
        const auto old = position_.size();
        const auto place = [&](int raw) -> const Vec3& {
            const auto at = static_cast<std::size_t>(raw);
            return at < old ? position_[at] : cut_world[at - old];
        };
        for (const auto& [raw, rim] : split.rim) {
            const Vec3 &low = place(rim.low), &high = place(rim.high);
            split.cap_point[raw - old - cut_world.size()] = low + rim.share * (high - low);
        }
    }

    // Cells that the path crosses, or nearly.
    std::vector<MappedCell> crossed_cells() const {
        std::vector<MappedCell> cells;
        const double a = matter_.lattice.spacing;
        const CellId count = static_cast<CellId>(matter_.cell_fill.size());
        for (CellId cell = 0; cell < count; ++cell) {
            const Vec3 middle = cell_middle(matter_, cell);
            if (std::abs(path_.height(middle)) < 2 * a * path_.steepest &&
                path_.near(path_.flat(middle), a)) {
                cells.push_back(map_.mapped(cell));
            }
        }
        return cells;
    }

    // From the rim inward: each beside one that is known.
    void find_cap_places(const SurfaceSplit& split, const std::vector<BodyPlace>& cut,
                         std::vector<BodyPlace>& places) const {
        if (split.cap_point.empty()) return;
        const std::vector<MappedCell> cells = crossed_cells();
        const int old = static_cast<int>(position_.size());
        const int first = old + static_cast<int>(cut.size());
        std::map<int, std::set<int>> beside;
        for (const SplitTriangle& t : split.triangle) {
            if (t.parent >= 0) continue;
            for (int k = 0; k < 3; ++k) {
                beside[t.raw[k]].insert({t.raw[(k + 1) % 3], t.raw[(k + 2) % 3]});
            }
        }
        std::deque<int> known;
        for (const auto& [raw, others] : beside) {
            if (raw < first) known.push_back(raw);
        }
        places.assign(split.cap_point.size(), {});  // without a cell: not known
        const auto place_of = [&](int raw) -> BodyPlace {
            return raw < old     ? mount_.place(raw)
                   : raw < first ? cut[raw - old]
                                 : places[raw - first];
        };
        for (const auto& [raw, rim] : split.rim) {
            const std::array<BodyPlace, 2> ends = {place_of(rim.low), place_of(rim.high)};
            const Vec3 &low = ends[0].reference, &high = ends[1].reference;
            places[raw - first] = pieces_.beside(low + rim.share * (high - low), ends);
            known.push_back(raw);
        }
        const auto spread = [&] {
            for (; !known.empty(); known.pop_front()) {
                const int raw = known.front();
                const BodyPlace near = place_of(raw);
                for (int other : beside[raw]) {
                    if (other < first || places[other - first].cell >= 0) continue;
                    places[other - first] =
                        map_.place_at(split.cap_point[other - first], cells, near, pieces_);
                    known.push_back(other);
                }
            }
        };
        spread();
        for (std::size_t n = 0; n < places.size(); ++n) {  // whom the rim does not reach
            if (places[n].cell >= 0) continue;
            const Vec3& point = split.cap_point[n];
            places[n] =
                map_.place_at(point, cells, {point, carrying_cell(matter_, point)}, pieces_);
            known.push_back(first + static_cast<int>(n));
            spread();
        }
    }

    void take_side(int v, const SidedPath& one, const Vec3& world) {
        const double a = matter_.lattice.spacing;
        const int own = one.own[v];
        if (own == 0 || std::abs(one.path.height(world)) > 4 * a * one.path.steepest) return;
        const CornerMask mask = corners_on_side(matter_, mount_.cell[v], one.path, own);
        if (mask == kAllCorners || !one.path.near(one.path.flat(world), 2 * a)) return;
        if (mount_.side[v] & mask) {
            mount_.side[v] &= mask;
        } else {
            change_cell(v, world);
        }
    }

    // None of the cell's corners is on the vertex's side of a path: the nearest cell takes it that
    // has one on its side of all.
    void change_cell(int v, const Vec3& world) {
        const double a = matter_.lattice.spacing;
        const Vec3& reference = mount_.reference[v];
        const int piece = pieces_.piece_of(mount_.place(v));
        const auto side_in = [&](CellId cell, const Vec3i&) -> CornerMask {
            CornerMask side = pieces_.side_of_piece(cell, reference, piece);
            for (const SidedPath& one : so_far_.path) {
                const bool parts = one.own[v] != 0 && one.path.near(one.path.flat(world), 2 * a);
                if (parts) side &= corners_on_side(matter_, cell, one.path, one.own[v]);
            }
            return side;
        };
        const CellSide best = nearest_side(matter_, mount_.cell[v], reference, side_in);
        if (best.cell < 0) return;  // a sliver without a particle of its own stays where it is
        mount_.cell[v] = best.cell;
        mount_.side[v] = best.side;
    }

    TriMesh& mesh_;
    const std::vector<Vec3>& position_;
    Mount& mount_;
    const Aggregate& matter_;
    const BladePath& path_;
    const Insides& insides_;
    CutSoFar& so_far_;  // in the end with this one
    const BodyMap map_;
    const PieceMap pieces_;
};

}  // namespace

CutResult cut_skin(TriMesh& mesh, const std::vector<Vec3>& position, Mount& mount,
                   const Aggregate& matter, const std::vector<std::array<Vec3, 3>>& sweep,
                   const Insides& insides) {
    CutResult result;
    const double a = matter.lattice.spacing;
    std::vector<Vec3> now = position;
    const BladePaths swept = paths_between_particles(sweep, box_of(position).widened(a), a);
    result.has_folded = swept.has_folded;
    for (const BladePath& path : swept.path) {
        if (path.relief) halve_edges_along(path, kBentEdge * a, mesh, now, mount, matter);
    }
    CutSoFar cut;
    for (const BladePath& path : swept.path) {
        if (result.cuts > 0) skin_positions(mount, matter, now);
        const SurfaceSplit split = PathCut(mesh, now, mount, matter, path, insides, cut).run();
        result.cuts += split.seam_edges > 0;
        result.open_parts += split.open_parts;
    }
    return result;
}

void remove_torn_triangles(TriMesh& mesh, const Mount& mount, const Aggregate& matter) {
    const PieceMap pieces(matter);
    std::vector<int> piece;
    for (std::size_t v = 0; v < mount.reference.size(); ++v) {
        piece.push_back(pieces.piece_of(mount.place(static_cast<int>(v))));
    }
    std::vector<char> keep;
    for (const Corners& c : mesh.triangle) {
        keep.push_back(piece[c[0]] == piece[c[1]] && piece[c[1]] == piece[c[2]]);
    }
    keep_triangles(mesh, keep);
}

}  // namespace swage
