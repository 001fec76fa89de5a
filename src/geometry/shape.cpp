// SPDX-License-Identifier: GPL-3.0-or-later
// Where two faces are equally near (an axis, the middle of a box), one of them is taken, always the
// same, so that every point has a normal.
#include "geometry/shape.h"

#include <algorithm>
#include <cmath>

#include "geometry/distance_field.h"

namespace swage {

namespace {

double sign_of(double value) { return value < 0 ? -1.0 : 1.0; }

// Across its wall, or of a solid one its whole self.
double wall_of(const CylinderShape& cylinder) {
    return cylinder.hole > 0 ? cylinder.radius - cylinder.hole : 2 * cylinder.radius;
}
double rounding_of(const CylinderShape& cylinder) {
    return std::clamp(cylinder.rounding, 0.0, 0.5 * std::min(wall_of(cylinder), cylinder.length));
}

Distance distance(const CylinderShape& cylinder, const Vec3& p) {
    const double from_axis = std::sqrt(p.x() * p.x() + p.y() * p.y());
    Vec3 radial = from_axis > 0 ? Vec3(p.x() / from_axis, p.y() / from_axis, 0) : Vec3::UnitX();
    const Vec3 axial(0, 0, sign_of(p.z()));
    // A smaller sharp one, grown by the rounding.
    const double rounding = rounding_of(cylinder);
    double beyond_side = from_axis - cylinder.radius;
    if (cylinder.hole > 0 && cylinder.hole - from_axis > beyond_side) {
        beyond_side = cylinder.hole - from_axis;
        radial = -radial;
    }
    beyond_side += rounding;
    const double beyond_end = std::abs(p.z()) - 0.5 * cylinder.length + rounding;
    if (beyond_side > 0 && beyond_end > 0) {
        const double value = std::sqrt(beyond_side * beyond_side + beyond_end * beyond_end);
        return {value - rounding, (beyond_side * radial + beyond_end * axial) / value};
    }
    return beyond_side >= beyond_end ? Distance{beyond_side - rounding, radial}
                                     : Distance{beyond_end - rounding, axial};
}

Distance distance(const BoxShape& box, const Vec3& p) {
    // A smaller sharp box, grown by the rounding.
    const double rounding = std::clamp(box.rounding, 0.0, 0.5 * box.size.minCoeff());
    const Vec3 beyond = p.cwiseAbs() - (0.5 * box.size - Vec3::Constant(rounding));
    const Vec3 outside = beyond.cwiseMax(0.0);
    const double length = outside.norm();
    if (length > 0) {
        Vec3 normal = outside / length;
        for (int axis = 0; axis < 3; ++axis) normal[axis] *= sign_of(p[axis]);
        return {length - rounding, normal};
    }
    int axis = 0;
    const double nearest = beyond.maxCoeff(&axis);
    return {nearest - rounding, sign_of(p[axis]) * Vec3::Unit(axis)};
}

Distance distance(const SphereShape& sphere, const Vec3& p) {
    const double length = p.norm();
    return {length - sphere.radius, length > 0 ? Vec3(p / length) : Vec3::UnitX()};
}

Distance distance(const MeshShape& mesh, const Vec3& p) { return mesh.field->at(p); }

Box centred(const Vec3& size) { return {-0.5 * size, 0.5 * size}; }
Box bounds(const CylinderShape& cylinder) {
    return centred({2 * cylinder.radius, 2 * cylinder.radius, cylinder.length});
}
Box bounds(const BoxShape& box) { return centred(box.size); }
Box bounds(const SphereShape& sphere) { return centred(Vec3::Constant(2 * sphere.radius)); }
Box bounds(const MeshShape& mesh) { return box_of(mesh.mesh->position); }

double thinness(const CylinderShape& cylinder) {
    return std::min(wall_of(cylinder), cylinder.length);
}
double thinness(const BoxShape& box) { return box.size.minCoeff(); }
double thinness(const SphereShape& sphere) { return 2 * sphere.radius; }
// Samples are as fine as it is thin.
double thinness(const MeshShape& mesh) { return 3 * mesh.field->spacing(); }

}  // namespace

Distance distance_to(const Shape& shape, const Vec3& point) {
    return std::visit([&](const auto& one) { return distance(one, point); }, shape);
}

bool is_convex(const Shape& shape) {
    const auto* cylinder = std::get_if<CylinderShape>(&shape);
    return cylinder != nullptr ? !(cylinder->hole > 0) : !std::holds_alternative<MeshShape>(shape);
}

double thinness_of(const Shape& shape) {
    return std::visit([](const auto& one) { return thinness(one); }, shape);
}

Box bounds_of(const Shape& shape) {
    return std::visit([](const auto& one) { return bounds(one); }, shape);
}

}  // namespace swage
