// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with soft edges, from regions of the plane given a thickness: wrench, plate with handles.
#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "geometry/implicit.h"
#include "geometry/made_shapes.h"

namespace swage {

namespace {

Vec2 turned(const Vec2& p, double angle) {
    return {portable::cos(angle) * p.x() + portable::sin(angle) * p.y(),
            -portable::sin(angle) * p.x() + portable::cos(angle) * p.y()};
}

double hexagon_distance(const Vec2& p, double across) {
    double d = -1e300;
    for (int i = 0; i < 3; ++i)
        d = std::max(d, std::abs(turned(p, kPi / 3 * i).y()) - 0.5 * across);
    return d;
}

// A wrench of length 1: ring at -x, open jaw at +x, its handle thinner and with a groove.
double wrench_distance(const Vec3& p) {
    const Vec2 flat(p.x(), p.z());
    const Vec2 ring = flat - Vec2(-0.415, 0), jaw = flat - Vec2(0.395, 0);
    const double handle_half = 0.040 + 0.012 * p.x();
    const double handle = plate_distance(round_rectangle_distance(flat, {0.40, handle_half}, 0.02),
                                         p.y(), 0.014, 0.011);
    double ends = std::min(ring.norm() - 0.085, jaw.norm() - 0.105);
    ends = plate_distance(ends, p.y(), 0.0205, 0.012);
    double d = smooth_union(handle, ends, 0.035);
    // The ring's hexagon with soft corners, the jaw's slot turned by 15 degrees.
    d = smooth_cut(d, hexagon_distance(ring, 0.098) - 0.004, 0.010);
    const Vec2 slot = turned(jaw, 15 * kPi / 180);
    d = smooth_cut(d, round_rectangle_distance(slot - Vec2(0.100, 0), {0.135, 0.042}, 0.030),
                   0.010);
    const double groove = round_rectangle_distance(flat, {0.255, 0.019}, 0.018);
    return smooth_cut(d, plate_distance(groove, std::abs(p.y()) - 0.020, 0.011, 0.006), 0.008);
}

// A shallow tray of length 1 with a loop at either end.
double plate_with_handles_distance(const Vec3& p) {
    const Vec2 flat(std::abs(p.x()), p.z());
    double region = round_rectangle_distance(flat, {0.325, 0.23}, 0.11);
    const Vec2 loop = flat - Vec2(0.36, 0);
    double handle = round_rectangle_distance(loop, {0.140, 0.150}, 0.10);
    region = smooth_union(region, handle, 0.06);
    double d = plate_distance(region, p.y(), 0.026, 0.024);
    const Vec2 hole = flat - Vec2(0.392, 0);
    d = smooth_cut(d, round_rectangle_distance(hole, {0.056, 0.090}, 0.045), 0.030);
    const double dish = round_rectangle_distance(flat, {0.270, 0.180}, 0.075);
    return smooth_cut(d, plate_distance(dish, p.y() - 0.040, 0.030, 0.024), 0.024);
}

TriMesh forge(const Field& unit, double depth, double sample, const ShapeValues& values) {
    FieldMeshSettings settings;
    settings.box = {{-0.53, -0.05, -depth}, {0.53, 0.05, depth}};
    settings.edge_length = 1 / values.at("division");
    settings.sample_spacing = std::min(sample, 0.7 * settings.edge_length);
    TriMesh mesh = mesh_of_field(unit, settings);
    // To the very length, about the middle.
    const Box box = box_of(mesh.position);
    const double scale = values.at("length") / box.size().x();
    for (Vec3& p : mesh.position) p = scale * (p - box.center());
    return mesh;
}

}  // namespace

TriMesh make_wrench(const ShapeValues& values) {
    return forge(wrench_distance, 0.14, 0.007, values);
}

TriMesh make_plate_with_handles(const ShapeValues& values) {
    return forge(plate_with_handles_distance, 0.26, 0.010, values);
}

}  // namespace swage
