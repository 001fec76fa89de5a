// SPDX-License-Identifier: GPL-3.0-or-later
// S1.13 moves each vertex out by its particle's radius along the mean normal. NOTE: the cells keep
// the share of their volume that was material, and the points of the true surface; vertices go
// there instead, and a common way along the normals makes up what volume is left.
#include "skin/voxel_place.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "skin/carrier.h"
#include "skin/cut_faces.h"
#include "skin/surface_samples.h"
#include "skin/voxel_crossings.h"
#include "skin/voxel_crumbs.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // points
constexpr int kEvenRounds = 4, kRounds = 6, kCutRounds = 40, kUnfoldRounds = 12, kPartRounds = 6;
constexpr double kFarthest = 2;   // spacings that a point may go from where the voxels have it
constexpr double kMostOut = 0.1;  // spacings, of a cut's rim above the surface
constexpr int kSlidingRings = 4;  // around a cut, of points that make room for its rim

bool broke_by_load(const Aggregate& matter, const VoxelFace& face) {
    const int axis = face.direction % 3;
    const auto corner = matter.lattice.cell_corners(face.cell);
    const ParticleId lower = corner[face.corner & ~(1 << axis)];
    const auto& damage = matter.connection[axis].damage;
    return face.cut && !damage.empty() && damage[lower] >= 1;
}

bool any_broke(const Aggregate& matter, const VoxelSurface& surface) {
    return std::ranges::any_of(surface.face,
                               [&](const VoxelFace& face) { return broke_by_load(matter, face); });
}

std::vector<Vec3> lattice_places(const Aggregate& matter, const VoxelSurface& surface) {
    std::vector<Vec3> place;
    place.reserve(surface.site.size());
    const CellBox box = cell_box(matter, 0);
    const Vec3 low = box.low - box.size.cwiseProduct(matter.lattice.cell_site(0).cast<double>());
    for (const HalfSite& at : surface.site) {
        place.push_back(low + 0.5 * box.size.cwiseProduct(Vec3(at[0], at[1], at[2])));
    }
    return place;
}

// NOTE: all keep their order of heights, so that next to nothing comes to lie on the other side of
// anything.
std::vector<Vec3> rest_places(const Aggregate& matter, const SurfaceSamples& samples,
                              const VoxelSurface& surface) {
    constexpr double kLeft = 0.1;
    std::vector<Vec3> place = lattice_places(matter, surface);
    if (samples.empty() || !any_broke(matter, surface)) return place;
    std::vector<char> far(place.size(), 0);
    parallel_each(place.size(), kChunk, [&](std::size_t s) {
        const double height = samples.height(place[s]);
        far[s] = height == SurfaceSamples::kNone;
        if (height > 0) samples.lower(kLeft * height, place[s]);
    });
    // A corner out of reach of the surface goes in between those beside it.
    std::vector<Vec3> sum(place.size(), Vec3::Zero());
    std::vector<int> count(place.size(), 0);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4 && !face.cut; ++k) {
            const int p = face.point[k];
            if (!far[p]) continue;
            for (int q : {face.point[(k + 1) % 4], face.point[(k + 3) % 4]}) {
                if (!far[q]) sum[p] += place[q], ++count[p];
            }
        }
    }
    for (std::size_t s = 0; s < place.size(); ++s) {
        if (count[s] > 0) place[s] = sum[s] / count[s];
    }
    return place;
}

class Placer {
  public:
    Placer(const Aggregate& matter, const SurfaceSamples& samples, const VoxelSurface& surface,
           const Warp& warp)
        : matter_(matter),
          surface_(surface),
          samples_(samples),
          warp_(warp),
          a_(matter.lattice.spacing),
          start_(lattice_places(matter, surface)),
          rest_(rest_places(matter, samples, surface)) {}

    // `surface`: the same.
    PointPlaces run(const Pieces& pieces, VoxelSurface& surface) {
        place_ = start_;
        find_kinds();
        target_ = cut_targets(matter_, surface_, place_);
        find_neighbors();
        open_rings();
        even_out();
        for (int round = 0; round < kRounds; ++round) settle(round > 0, false);
        // The steps of a cut take longer to even out, for only then no triangle is folded.
        for (int round = 0; round < kCutRounds && any_cut(); ++round) settle(true, true);
        hold_rims();
        unfold();
        drop_crumbs(matter_, pieces, place_, surface);
        if (!warp_.is_none()) roughen();
        make_up_volume();
        unfold();
        part_and_fill();
        return {std::move(place_), std::move(start_), std::move(rest_)};
    }

  private:
    // What parts crossings takes or adds volume, and what makes that up may cross anew: of what
    // does not cross, that with the least error stays.
    void part_and_fill() {
        std::vector<Vec3> best;
        double least = std::numeric_limits<double>::infinity();
        for (int round = 0; round < kPartRounds; ++round) {
            const bool any = part_all();
            const double off = std::abs(matter_.volume() - volume());
            if (off < least) least = off, best = place_;
            if (!any) break;
            make_up_volume();
        }
        place_ = std::move(best);
    }

    // In parts hardly wider than a cell places at rest may cross; the voxels never do.
    bool part_all() {
        const bool any = part_crossings(facets(), rest_, blade_, a_, place_);
        return part_crossings(facets(), start_, blade_, a_, place_) || any;
    }
    std::vector<Facet> facets() const {
        std::vector<Facet> facet;
        for (const VoxelFace& face : surface_.face)
            facet.push_back({.corner = face.point, .diagonal = face.diagonal});
        return facet;
    }
    std::size_t count() const { return surface_.site.size(); }

    // Whether a point lies on the outer surface, exactly so or only near it.
    void find_kinds() {
        outer_.assign(count(), 0);
        on_cut_.assign(count(), 0);
        blade_.assign(count(), 0);
        exact_.assign(count(), 1);
        fixed_axis_.assign(count(), 0);
        normal_.assign(count(), Vec3::Zero());
        for (const VoxelFace& face : surface_.face) {
            const bool blade = face.cut && !broke_by_load(matter_, face);
            for (int p : face.point) on_cut_[p] |= face.cut, blade_[p] |= blade;
            if (face.cut) continue;
            bool full = samples_.empty() || matter_.cell_fill[face.cell] > 1 - 1e-5f;
            for (int p : face.point) full = full && !near_dropped(surface_.site[p]);
            const int axis = face.direction % 3;
            for (int p : face.point) {
                outer_[p] = 1;
                exact_[p] &= full;
                fixed_axis_[p] |= 1 << axis;
                normal_[p][axis] += face.direction < 3 ? 1 : -1;
            }
        }
        for (Vec3& n : normal_) n = n.norm() > 0 ? n.normalized() : Vec3(Vec3::UnitX());
        facing_ = normal_;
    }

    bool near_dropped(const HalfSite& site) const {
        if (!any_dropped_) return false;
        for (int n = 0; n < 8; ++n) {
            std::array<int, 3> cell;
            int corner = 0;
            for (int d = 0; d < 3; ++d) {
                const int voxel = site[d] + (n >> d & 1) - 1;
                cell[d] = voxel >> 1;
                corner |= (voxel & 1) << d;
            }
            const CellId at = matter_.lattice.cell_at(cell[0], cell[1], cell[2]);
            if (at >= 0 && !(surface_.kept[at] >> corner & 1)) return true;
        }
        return false;
    }

    // Points joined by an edge of the surface: on a rim, along it; on a cut, within it.
    void find_neighbors() {
        std::vector<std::pair<int, int>> pairs;
        for (const VoxelFace& face : surface_.face) {
            for (int k = 0; k < 4; ++k) {
                const int p = face.point[k], q = face.point[(k + 1) % 4];
                for (const auto& [from, to] : {std::pair(p, q), std::pair(q, p)}) {
                    const bool rim = outer_[from] && target_[from];
                    if (rim ? outer_[to] && target_[to] : !face.cut || !outer_[from]) {
                        pairs.emplace_back(from, to);
                    }
                }
            }
        }
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        first_.assign(count() + 1, 0);
        for (const auto& [from, to] : pairs) ++first_[from + 1], neighbor_.push_back(to);
        for (std::size_t s = 0; s < count(); ++s) first_[s + 1] += first_[s];
    }

    // Exact points stay where they are, but near a cut they slide to make room.
    void open_rings() {
        slides_.assign(count(), 0);
        for (std::size_t s = 0; s < count(); ++s) slides_[s] = target_[s].has_value();
        for (int ring = 0; ring < kSlidingRings; ++ring) {
            std::vector<char> wider = slides_;
            for (std::size_t s = 0; s < count(); ++s) {
                if (!slides_[s]) continue;
                for (int n = first_[s]; n < first_[s + 1]; ++n) wider[neighbor_[n]] = 1;
            }
            // A rim's neighbours are only those on the rim: widen from outside as well.
            for (std::size_t s = 0; s < count(); ++s) {
                for (int n = first_[s]; n < first_[s + 1] && !wider[s]; ++n) {
                    wider[s] = slides_[neighbor_[n]];
                }
            }
            slides_ = std::move(wider);
        }
    }

    Vec3 mean_of_neighbors(std::size_t s) const {
        Vec3 sum = Vec3::Zero();
        for (int n = first_[s]; n < first_[s + 1]; ++n) sum += place_[neighbor_[n]];
        return first_[s] == first_[s + 1] ? place_[s] : Vec3(sum / (first_[s + 1] - first_[s]));
    }

    Vec3 free_part(std::size_t s, Vec3 way) const {
        for (int axis = 0; axis < 3; ++axis) {
            if (fixed_axis_[s] >> axis & 1) way[axis] = 0;
        }
        return way;
    }

    void to_cut(std::size_t s, Vec3& p) const {
        const CutTarget& cut = *target_[s];
        Vec3 way = cut.normal;
        if (outer_[s]) {
            way = exact_[s] ? free_part(s, way) : Vec3(way - way.dot(normal_[s]) * normal_[s]);
        }
        const double slope = way.dot(cut.normal);
        if (slope < 0.05) return;  // the cut runs along the surface
        Vec3 step = (cut.height - cut.normal.dot(p)) / slope * way;
        if (step.norm() > a_) step *= a_ / step.norm();
        p += step;
    }

    void stay_near(std::size_t s, Vec3& p) const {
        const Vec3 way = p - start_[s];
        const double far = way.norm(), most = kFarthest * a_;
        if (far > most) p = start_[s] + most / far * way;
    }

    bool any_cut() const {
        return std::any_of(slides_.begin(), slides_.end(), [](char slides) { return slides; });
    }

    // Evens out the voxels' steps, which on a slope stand one over the other, and has the points
    // face as the surface then does.
    void even_out() {
        const auto moves = [&](std::size_t s) { return outer_[s] && !exact_[s] && !on_cut_[s]; };
        for (int round = 0; round < kEvenRounds; ++round) {
            std::vector<Vec3> next = place_;
            parallel_each(count(), kChunk, [&](std::size_t s) {
                if (moves(s)) next[s] += 0.5 * (mean_of_neighbors(s) - place_[s]);
            });
            place_ = std::move(next);
        }
        std::vector<Vec3> sum(count(), Vec3::Zero());
        for (const VoxelFace& face : surface_.face) {
            if (face.cut) continue;
            const Vec3 own = (place_[face.point[2]] - place_[face.point[0]])
                                 .cross(place_[face.point[3]] - place_[face.point[1]]);
            for (int p : face.point) sum[p] += own;
        }
        for (std::size_t s = 0; s < count(); ++s) {
            if (moves(s) && sum[s].norm() > 0) normal_[s] = facing_[s] = sum[s].normalized();
        }
    }

    void settle(bool relax, bool only_at_cuts) {
        std::vector<Vec3> next = place_;
        parallel_each(count(), kChunk, [&](std::size_t s) {
            if (only_at_cuts && !slides_[s]) return;
            Vec3& p = next[s];
            const bool cut = target_[s].has_value();
            if (on_cut_[s] && !cut) {  // rubble keeps the lattice's steps
                p = rest_[s];
                return;
            }
            if (outer_[s] && exact_[s]) {
                if (cut) {
                    to_cut(s, p);
                } else if (relax && slides_[s]) {
                    p += 0.5 * free_part(s, mean_of_neighbors(s) - p);
                }
                return;
            }
            if (relax) {
                Vec3 way = mean_of_neighbors(s) - p;
                if (outer_[s]) way -= way.dot(normal_[s]) * normal_[s];
                if (cut) way -= way.dot(target_[s]->normal) * target_[s]->normal;
                p += 0.5 * way;
            }
            if (outer_[s]) samples_.project(facing_[s], p, normal_[s]);
            if (cut) to_cut(s, p);
            if (cut && outer_[s]) {
                samples_.project(facing_[s], p, normal_[s]);
                to_cut(s, p);
            }
            stay_near(s, p);
        });
        place_ = std::move(next);
    }

    // A cut that runs nearly along the surface leads points of its rim out of the body.
    void hold_rims() {
        if (samples_.empty()) return;
        parallel_each(count(), kChunk, [&](std::size_t s) {
            if (outer_[s] && on_cut_[s]) samples_.lower(kMostOut, place_[s]);
        });
    }

    // In parts hardly wider than a cell the nearest surface may be round the corner. Points of
    // faces that look inwards are drawn in between their neighbours, along the surface, until none
    // is left; at last wherever that may be.
    void unfold() {
        for (int round = 0; round < kUnfoldRounds; ++round) {
            std::vector<char> folded(count(), 0);
            bool any = false;
            for (const VoxelFace& face : surface_.face) {
                if (face.cut) continue;
                Vec3 outward = Vec3::Zero();
                for (int p : face.point) outward += normal_[p];
                for (int k = 0; k < 4; ++k) {
                    const Vec3& p = place_[face.point[k]];
                    const Vec3 turn = (place_[face.point[(k + 1) % 4]] - p)
                                          .cross(place_[face.point[(k + 3) % 4]] - p);
                    if (turn.dot(outward) >= 0) continue;
                    for (int q : face.point) folded[q] = 1;
                    any = true;
                }
            }
            if (!any) return;
            std::vector<Vec3> next = place_;
            for (std::size_t s = 0; s < count(); ++s) {
                if (!folded[s] || exact_[s] || target_[s]) continue;
                next[s] += 0.7 * (mean_of_neighbors(s) - place_[s]);
                Vec3 unused;
                const bool last = round == kUnfoldRounds - 1;
                if (outer_[s] && !last) samples_.project(normal_[s], next[s], unused);
            }
            place_ = std::move(next);
        }
    }

    // Points of faces that no blade made; on the outer surface along it.
    void roughen() {
        for (std::size_t s = 0; s < count(); ++s) {
            if (!on_cut_[s] || blade_[s]) continue;
            Vec3& p = place_[s];
            const HalfSite& at = surface_.site[s];
            Vec3 way = warp_.rough(p) + warp_.grain({at[0], at[1], at[2]}) - p;
            if (outer_[s] && exact_[s]) way = free_part(s, way);
            if (outer_[s] && !exact_[s]) way -= way.dot(normal_[s]) * normal_[s];
            p += way;
            if (outer_[s] && !exact_[s]) samples_.project(facing_[s], p, normal_[s]);
        }
    }

    double volume() const {
        const Vec3 center = place_.front();
        double six = 0;
        for (const VoxelFace& face : surface_.face) {
            const Vec3 p = place_[face.point[0]] - center, q = place_[face.point[1]] - center;
            const Vec3 r = place_[face.point[2]] - center, t = place_[face.point[3]] - center;
            six += 0.5 *
                   (p.dot(q.cross(r)) + p.dot(r.cross(t)) + q.dot(r.cross(t)) + q.dot(t.cross(p)));
        }
        return six / 6;
    }

    void make_up_volume() {
        for (int round = 0; round < 3; ++round) {
            std::vector<Vec3> out(count(), Vec3::Zero());
            double area = 0;
            for (const VoxelFace& face : surface_.face) {
                const Vec3 own = 0.5 * (place_[face.point[2]] - place_[face.point[0]])
                                           .cross(place_[face.point[3]] - place_[face.point[1]]);
                for (int p : face.point) {
                    if (face.cut || exact_[p]) continue;
                    out[p] += own;
                    area += own.norm() / 4;
                }
            }
            if (!(area > 0)) return;
            double way = (matter_.volume() - volume()) / area;
            way = std::clamp(way, -0.2 * a_, 0.2 * a_);
            for (std::size_t s = 0; s < count(); ++s) {
                if (out[s].norm() == 0) continue;
                Vec3 step = way * out[s].normalized();
                if (target_[s]) step -= step.dot(target_[s]->normal) * target_[s]->normal;
                place_[s] += step;
            }
        }
    }

    const Aggregate& matter_;
    const VoxelSurface& surface_;
    const SurfaceSamples& samples_;
    const Warp& warp_;
    const double a_;
    const bool any_dropped_ = std::any_of(surface_.kept.begin(), surface_.kept.end(),
                                          [](CornerMask kept) { return kept != kAllCorners; });
    std::vector<Vec3> start_, rest_;
    std::vector<Vec3> place_, normal_;
    std::vector<Vec3> facing_;  // normals before it meets the true surface: tell edges from sides
    std::vector<char> outer_, on_cut_, blade_, exact_, fixed_axis_, slides_;
    std::vector<std::optional<CutTarget>> target_;
    std::vector<int> first_, neighbor_;
};

}  // namespace

PointPlaces place_points(const Aggregate& matter, const Pieces& pieces,
                         const SurfaceSamples& samples, const Warp& warp, VoxelSurface& surface) {
    if (surface.face.empty()) return {};
    return Placer(matter, samples, surface, warp).run(pieces, surface);
}

}  // namespace swage
