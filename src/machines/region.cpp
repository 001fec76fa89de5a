// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/region.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "geometry/disjoint_sets.h"
#include "laws/pressure.h"
#include "matter/point_side.h"

namespace swage {

namespace {

// Patches of a smooth surface lie at most about this far apart, in spacings; those of two sides of
// a thin wall may lie nearer, but look apart.
constexpr double kNeighbour = 0.9;
constexpr double kLooksApart = -0.5;
// Of a closed surface the areas that look one way and the other are one; those of a bowl whose rim
// is too sharp for its outside to be found around it differ by its mouth. Coarse patches are flat.
constexpr double kMouth = 0.1;  // of the area

Side side_of(const Vec3& normal) {
    constexpr Side kSides[] = {Side::left, Side::right, Side::bottom,
                               Side::top,  Side::back,  Side::front};
    int axis;
    normal.cwiseAbs().maxCoeff(&axis);
    return kSides[2 * axis + (normal[axis] > 0)];
}

// Points chosen from a surface, to be looked up by those near them, as it was molded.
class NearPoints {
  public:
    NearPoints(const Aggregate& matter, const std::vector<int>& points)
        : matter_(matter), points_(points) {
        for (std::size_t n = 0; n < points.size(); ++n) {
            const Vec3 place = matter.surface_reference(std::size_t(points[n]));
            there_[key_of(site_of(place))].push_back({static_cast<int>(n), place});
        }
    }

    // Whether `meets` holds of any neighbour of a point of the surface, by its number among those
    // chosen; none after that is asked.
    template <typename Meets>
    bool any(std::size_t point, const Meets& meets) const {
        const Vec3 place = matter_.surface_reference(point);
        const Vec3i home = site_of(place);
        for (int n = 0; n < 27; ++n) {
            const auto at = there_.find(key_of(home + neighbor_step(n)));
            if (at == there_.end()) continue;
            for (const auto& [number, where] : at->second) {
                const std::size_t other = std::size_t(points_[std::size_t(number)]);
                if ((place - where).norm() < kNeighbour * matter_.lattice.spacing &&
                    matter_.surface.normal(point).dot(matter_.surface.normal(other)) >
                        kLooksApart &&
                    meets(number)) {
                    return true;
                }
            }
        }
        return false;
    }

  private:
    struct At {
        int number;
        Vec3 place;
    };
    Vec3i site_of(const Vec3& place) const {
        const Lattice& lattice = matter_.lattice;
        return ((place - lattice.origin) / lattice.spacing).array().floor().cast<int>();
    }

    const Aggregate& matter_;
    const std::vector<int>& points_;
    std::unordered_map<std::uint64_t, std::vector<At>> there_;  // looked up only
};

struct HangTogether {
    std::vector<std::size_t> of;  // by point: which
    std::size_t count = 0;
};

// Points that are chosen from a surface by what hangs together, as it was molded.
HangTogether hang_together(const Aggregate& matter, const std::vector<int>& points) {
    const NearPoints near(matter, points);
    DisjointSets sets(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        near.any(std::size_t(points[n]), [&](int m) {
            sets.unite(static_cast<int>(n), m);
            return false;
        });
    }
    std::vector<int> set_of;
    const auto count = std::size_t(sets.number_sets(set_of));
    return {{set_of.begin(), set_of.end()}, count};
}

}  // namespace

// Half a cell across the normal, as far along it as it slants, less where it is cut off.
Box patch_box(const Aggregate& matter, const Mat3& frame_from_world, std::size_t point,
              const Vec3& in_frame) {
    const double half = 0.5 * matter.lattice.spacing;
    const Vec3 normal = matter.surface.normal(point).cwiseAbs();
    int steepest;
    const double steep = normal.maxCoeff(&steepest);
    const double width = half * std::min(1.0, std::sqrt(matter.surface.area(point) * steep) / half);
    Vec3 size = Vec3::Constant(width);
    size[steepest] = std::min(half, width * (normal.sum() - steep) / steep);
    const Mat3 along = frame_from_world * gradient_on_side(matter, point) * size.asDiagonal();
    const Vec3 reach = 0.5 * along.cwiseAbs().rowwise().sum();
    return {in_frame - reach, in_frame + reach};
}

double share_within(const Box& patch, const Box& region) {
    double share = 1;
    for (int i = 0; i < 3; ++i) {
        const double low = patch.low[i], high = patch.high[i], size = high - low;
        const double within = std::min(high, region.high[i]) - std::max(low, region.low[i]);
        share *= size > 0 ? std::clamp(within / size, 0.0, 1.0) : within >= 0;
    }
    return share;
}

std::vector<char> cavity_walls(const Aggregate& matter) {
    std::vector<int> all(matter.surface.size());
    std::iota(all.begin(), all.end(), 0);
    const HangTogether parts = hang_together(matter, all);
    std::vector<double> area(parts.count, 0.0), volume(parts.count, 0.0);
    std::vector<Vec3> middle(parts.count, Vec3::Zero()), mouth(parts.count, Vec3::Zero());
    for (std::size_t p = 0; p < all.size(); ++p) {
        area[parts.of[p]] += matter.surface.area(p);
        mouth[parts.of[p]] += matter.surface.area(p) * matter.surface.normal(p);
        middle[parts.of[p]] += matter.surface.area(p) * matter.surface_reference(p);
    }
    for (std::size_t p = 0; p < all.size(); ++p) {
        const Vec3 from_middle =
            matter.surface_reference(p) - middle[parts.of[p]] / area[parts.of[p]];
        volume[parts.of[p]] +=
            matter.surface.area(p) * matter.surface.normal(p).dot(from_middle) / 3;
    }
    std::vector<char> is_wall(all.size());
    for (std::size_t p = 0; p < all.size(); ++p) {
        const std::size_t part = parts.of[p];
        is_wall[p] = volume[part] < 0 && mouth[part].norm() < kMouth * area[part];
    }
    return is_wall;
}

SurfacePart find_region(const Aggregate& matter, const Pose& world_from_work,
                        const std::vector<Vec3>& in_work, Side side, const Box* box) {
    constexpr double kNothing = 1e-6;  // of a patch
    const Quat work_from_world = world_from_work.rotation.conjugate();
    const Mat3 turn = work_from_world.toRotationMatrix();
    std::vector<char> is_wall;
    if (side == Side::inside) is_wall = cavity_walls(matter);
    SurfacePart part;
    bool is_whole = true;
    for (std::size_t p = 0; p < in_work.size(); ++p) {
        double share = 1;
        if (box != nullptr) {
            share = share_within(patch_box(matter, turn, p, in_work[p]), *box);
            if (share < kNothing) continue;
        }
        if (side == Side::inside) {
            if (!is_wall[p]) continue;
        } else if (side != Side::all) {
            const Vec3 normal =
                present_area<double>(gradient_on_side(matter, p), matter.surface.normal(p));
            if (side_of(work_from_world * normal) != side) continue;
        }
        part.point.push_back(static_cast<int>(p));
        part.share.push_back(share);
        is_whole &= share > 1 - kNothing;
    }
    if (is_whole) part.share.clear();
    return part;
}

double patch_area(const Aggregate& matter, std::size_t point) {
    constexpr double kRounded = 1e-6;  // what is not strained keeps the area that it has to the bit
    const double area = matter.surface.area(point);
    if (matter.surface.is_loose(point)) return area;
    const double stretch =
        present_area<double>(gradient_on_side(matter, point), matter.surface.normal(point)).norm();
    return std::abs(stretch - 1) < kRounded ? area : stretch * area;
}

std::vector<SurfaceComponent> components_of(const Aggregate& matter, const SurfacePart& part) {
    const HangTogether parts = hang_together(matter, part.point);
    std::vector<SurfaceComponent> components(parts.count, {0, Vec3::Zero()});
    for (std::size_t n = 0; n < part.point.size(); ++n) {
        const std::size_t p = std::size_t(part.point[n]);
        const double area = part.share_of(n) * patch_area(matter, p);
        SurfaceComponent& component = components[parts.of[n]];
        component.area += area;
        component.middle += area * position_on_side(matter, p);
    }
    for (SurfaceComponent& one : components) {
        if (one.area > 0) one.middle /= one.area;
    }
    std::stable_sort(components.begin(), components.end(),
                     [](const auto& a, const auto& b) { return a.area > b.area; });
    return components;
}

bool are_whole_surfaces(const Aggregate& matter, const std::vector<int>& points) {
    if (points.size() == matter.surface.size()) return true;
    const NearPoints near(matter, points);
    std::vector<char> is_chosen(matter.surface.size(), 0);
    for (int p : points) is_chosen[std::size_t(p)] = 1;
    for (std::size_t p = 0; p < is_chosen.size(); ++p) {
        if (!is_chosen[p] && near.any(p, [](int) { return true; })) return false;
    }
    return true;
}

}  // namespace swage
