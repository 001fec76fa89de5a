// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: J. Hart, "Sphere tracing", 1996, and I. Quilez's articles on distance functions
// (ellipsoid estimate, cone between two balls, polynomial smooth minimum).
#include "geometry/implicit.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/remesh.h"
#include "geometry/surface_nets.h"

namespace swage {

double ball_distance(const Vec3& point, const Vec3& center, double radius) {
    return (point - center).norm() - radius;
}

double ellipsoid_distance(const Vec3& from_center, const Vec3& radii) {
    const double first = from_center.cwiseQuotient(radii).norm();
    const double second = from_center.cwiseQuotient(radii.cwiseAbs2()).norm();
    if (!(second > 0)) return -radii.minCoeff();
    return first * (first - 1) / second;
}

double limb_distance(const Vec3& point, const Vec3& a, double radius_a, const Vec3& b,
                     double radius_b) {
    const Vec3 axis = b - a, from_a = point - a;
    const double length = axis.norm();
    const double narrowing = radius_a - radius_b;
    if (length <= std::abs(narrowing))  // one ball holds the other
        return std::min(ball_distance(point, a, radius_a), ball_distance(point, b, radius_b));
    // In the half plane of the axis: the straight side leans by the angle whose sine is
    // narrowing / length; beyond its ends the balls are nearest.
    const double sine = narrowing / length, cosine = std::sqrt(1 - sine * sine);
    const double along = from_a.dot(axis) / length;
    const double across = std::sqrt(std::max(0.0, from_a.squaredNorm() - along * along));
    const double foot = along * cosine - across * sine;
    if (foot < 0) return from_a.norm() - radius_a;
    if (foot > length * cosine) return (point - b).norm() - radius_b;
    return along * sine + across * cosine - radius_a;
}

double round_rectangle_distance(const Vec2& point, const Vec2& half, double rounding) {
    const Vec2 q = point.cwiseAbs() - half + Vec2::Constant(rounding);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double plate_distance(double region, double height, double half, double rounding) {
    const Vec2 q(region + rounding, std::abs(height) - half + rounding);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double smooth_union(double a, double b, double soft) {
    const double overlap = std::max(soft - std::abs(a - b), 0.0) / soft;
    return std::min(a, b) - 0.25 * soft * overlap * overlap;
}

double smooth_cut(double body, double tool, double soft) {
    return -smooth_union(-body, tool, soft);
}

Vec3 field_gradient(const Field& field, const Vec3& point, double reach) {
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 offset = reach * Vec3(Vec3::Unit(axis));
        gradient[axis] = (field(point + offset) - field(point - offset)) / (2 * reach);
    }
    return gradient;
}

namespace {

ScalarGrid sample(const Field& field, const Box& box, double spacing) {
    ScalarGrid grid;
    grid.spacing = spacing;
    grid.count = (box.size() / spacing).array().ceil().cast<int>() + 3;
    grid.origin = box.center() - 0.5 * spacing * (grid.count.cast<double>() - Vec3::Ones());
    grid.value.resize(grid.count.cast<std::size_t>().prod());
    parallel_for(grid.count.z(), [&](std::size_t layer) {
        const int k = static_cast<int>(layer);
        for (int j = 0; j < grid.count.y(); ++j)
            for (int i = 0; i < grid.count.x(); ++i)
                grid.value[grid.index(i, j, k)] = field(grid.point(i, j, k));
    });
    return grid;
}

}  // namespace

TriMesh mesh_of_field(const Field& field, const FieldMeshSettings& settings) {
    const double reach = 0.05 * settings.edge_length;
    RemeshSettings even;
    even.rounds = settings.rounds;
    even.edge_length = settings.edge_length_at ? settings.edge_length_at
                                               : [&](const Vec3&) { return settings.edge_length; };
    // Newton's steps along the gradient, kept short so that none leaps through a thin part.
    even.project = [&](const Vec3& point) {
        Vec3 p = point;
        for (int i = 0; i < 4; ++i) {
            const double value = field(p);
            if (std::abs(value) < 1e-4 * settings.edge_length) break;
            const Vec3 gradient = field_gradient(field, p, reach);
            Vec3 shift = -value / std::max(gradient.squaredNorm(), 0.05) * gradient;
            const double most = 0.3 * settings.edge_length;
            if (shift.norm() > most) shift *= most / shift.norm();
            p += shift;
        }
        return p;
    };
    return remesh(surface_nets(sample(field, settings.box, settings.sample_spacing)), even);
}

}  // namespace swage
