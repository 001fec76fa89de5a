// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/sweep_plane.h"

#include <algorithm>
#include <map>

#include "geometry/disjoint_sets.h"
#include "skin/flat_segment.h"

namespace swage {

namespace {

bool holds(const std::array<Vec2, 3>& t, const Vec2& p) {
    const double a = cross(t[1] - t[0], p - t[0]);
    const double b = cross(t[2] - t[1], p - t[1]);
    const double c = cross(t[0] - t[2], p - t[2]);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// One sweep for each blade: triangles that hang together by corners.
std::vector<std::vector<std::array<Vec3, 3>>> separate_sweeps(
    const std::vector<std::array<Vec3, 3>>& sweep) {
    std::map<std::array<double, 3>, int> first;
    DisjointSets sets(sweep.size());
    for (std::size_t t = 0; t < sweep.size(); ++t) {
        for (const Vec3& p : sweep[t]) {
            const auto [at, fresh] =
                first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, static_cast<int>(t));
            if (!fresh) sets.unite(at->second, static_cast<int>(t));
        }
    }
    std::vector<int> number;
    std::vector<std::vector<std::array<Vec3, 3>>> separate(sets.number_sets(number));
    for (std::size_t t = 0; t < sweep.size(); ++t) separate[number[t]].push_back(sweep[t]);
    return separate;
}

// As that of a blade at rest.
bool has_no_area(const std::vector<std::array<Vec3, 3>>& sweep) {
    return std::ranges::all_of(
        sweep, [](const auto& t) { return (t[1] - t[0]).cross(t[2] - t[0]).norm() == 0; });
}

// What of a sweep comes near the box.
std::vector<std::array<Vec3, 3>> near_box(const std::vector<std::array<Vec3, 3>>& sweep,
                                          const Box& box) {
    std::vector<std::array<Vec3, 3>> near;
    for (const std::array<Vec3, 3>& t : sweep) {
        if (box_of({t.begin(), t.end()}).overlaps(box)) near.push_back(t);
    }
    return near;
}

}  // namespace

bool SweepPlane::near(const Vec2& p, double reach) const {
    for (const auto& t : triangle) {
        const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
        const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
        if ((p.array() < low.array() - reach).any() || (p.array() > high.array() + reach).any()) {
            continue;
        }
        if (holds(t, p)) return true;
        for (int k = 0; k < 3 && reach > 0; ++k) {
            if (distance2_to_segment(p, t[k], t[(k + 1) % 3]) <= reach * reach) return true;
        }
    }
    return false;
}

std::optional<SweepPlane> fit_sweep_plane(const std::vector<std::array<Vec3, 3>>& sweep,
                                          double tolerance) {
    // A blade that goes forth and back sweeps areas of both signs.
    Vec3 area = Vec3::Zero(), center = Vec3::Zero();
    double total = 0;
    for (const auto& t : sweep) {
        Vec3 own = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
        if (own.dot(area) < 0) own = -own;
        area += own;
        center += own.norm() * (t[0] + t[1] + t[2]) / 3;
        total += own.norm();
    }
    if (!(total > 0)) return std::nullopt;

    SweepPlane plane;
    plane.point = center / total;
    plane.normal = area.normalized();
    int least = 0;
    plane.normal.cwiseAbs().minCoeff(&least);
    plane.across = plane.normal.cross(Vec3::Unit(least)).normalized();
    plane.up = plane.normal.cross(plane.across);
    struct Use {
        std::array<Vec2, 2> edge;
        int count = 0;
    };
    std::map<std::array<double, 6>, Use> uses;  // by the ends in the world, which agree to the bit
    for (const auto& t : sweep) {
        for (const Vec3& p : t) {
            if (std::abs(plane.height(p)) > tolerance) return std::nullopt;
        }
        if ((t[1] - t[0]).cross(t[2] - t[0]).norm() == 0) continue;
        plane.triangle.push_back({plane.flat(t[0]), plane.flat(t[1]), plane.flat(t[2])});
        for (int k = 0; k < 3; ++k) {
            const Vec3 &a = t[k], &b = t[(k + 1) % 3];
            std::array<double, 6> key = {a[0], a[1], a[2], b[0], b[1], b[2]};
            const std::array<double, 6> back = {b[0], b[1], b[2], a[0], a[1], a[2]};
            Use& use = uses[std::min(key, back)];
            use.edge = {plane.flat(a), plane.flat(b)};
            ++use.count;
        }
    }
    for (const auto& [key, use] : uses) {
        if (use.count == 1) plane.outline.push_back(use.edge);
    }
    return plane;
}

SweepPlanes sweep_planes(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                         double tolerance) {
    SweepPlanes found;
    for (const std::vector<std::array<Vec3, 3>>& one : separate_sweeps(sweep)) {
        if (const auto plane = fit_sweep_plane(one, tolerance)) {
            found.plane.push_back(*plane);
            continue;
        }
        for (const std::vector<std::array<Vec3, 3>>& part : separate_sweeps(near_box(one, box))) {
            if (has_no_area(part)) continue;
            const auto plane = fit_sweep_plane(part, tolerance);
            if (plane) found.plane.push_back(*plane);
            found.has_curved = found.has_curved || !plane;
        }
    }
    return found;
}

}  // namespace swage
