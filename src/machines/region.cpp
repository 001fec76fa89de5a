// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/region.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "laws/pressure.h"

namespace swage {

namespace {

// Patches of a smooth surface lie at most about this far apart, in spacings; those of two sides of
// a thin wall may lie nearer, but look apart.
constexpr double kNeighbour = 0.9;
constexpr double kLooksApart = -0.5;

Side side_of(const Vec3& normal) {
    constexpr Side kSides[] = {Side::left, Side::right, Side::bottom,
                               Side::top,  Side::back,  Side::front};
    int axis;
    normal.cwiseAbs().maxCoeff(&axis);
    return kSides[2 * axis + (normal[axis] > 0)];
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
    const Mat3 along = frame_from_world * matter.surface_gradient(point) * size.asDiagonal();
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

SurfacePart find_region(const Aggregate& matter, const Pose& world_from_work,
                        const std::vector<Vec3>& in_work, Side side, const Box* box) {
    constexpr double kNothing = 1e-6;  // of a patch
    const Quat work_from_world = world_from_work.rotation.conjugate();
    const Mat3 turn = work_from_world.toRotationMatrix();
    SurfacePart part;
    bool is_whole = true;
    for (std::size_t p = 0; p < in_work.size(); ++p) {
        double share = 1;
        if (box != nullptr) {
            share = share_within(patch_box(matter, turn, p, in_work[p]), *box);
            if (share < kNothing) continue;
        }
        if (side != Side::all) {
            const Vec3 normal =
                present_area<double>(matter.surface_gradient(p), matter.surface.normal(p));
            if (side_of(work_from_world * normal) != side) continue;
        }
        part.point.push_back(static_cast<int>(p));
        part.share.push_back(share);
        is_whole &= share > 1 - kNothing;
    }
    if (is_whole) part.share.clear();
    return part;
}

bool is_closed(const Aggregate& matter, const std::vector<int>& points) {
    const SurfacePoints& surface = matter.surface;
    if (points.size() == surface.size()) return true;
    const double a = matter.lattice.spacing;
    std::vector<Vec3> place;
    for (std::size_t p = 0; p < surface.size(); ++p) place.push_back(matter.surface_reference(p));
    const auto site_of = [&](std::size_t p) -> Vec3i {
        return ((place[p] - matter.lattice.origin) / a).array().floor().cast<int>();
    };
    std::unordered_map<std::uint64_t, std::vector<int>> chosen;  // looked up only
    std::vector<char> is_chosen(surface.size(), 0);
    for (int p : points) {
        chosen[key_of(site_of(p))].push_back(p);
        is_chosen[p] = 1;
    }
    for (std::size_t p = 0; p < surface.size(); ++p) {
        if (is_chosen[p]) continue;
        const Vec3i home = site_of(p);
        for (int n = 0; n < 27; ++n) {
            const auto at = chosen.find(key_of(home + neighbor_step(n)));
            if (at == chosen.end()) continue;
            for (int q : at->second) {
                const double way = (place[p] - place[q]).norm();
                if (way < kNeighbour * a &&
                    surface.normal(p).dot(surface.normal(q)) > kLooksApart) {
                    return false;
                }
            }
        }
    }
    return true;
}

}  // namespace swage
