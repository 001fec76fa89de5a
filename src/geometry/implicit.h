// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies given by a function that is negative inside: soft primitives, their blends, and the way
// to an even mesh. Distances are exact only for single primitives; blends stay close to them.
#pragma once

#include <functional>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

using Field = std::function<double(const Vec3&)>;  // [m], about a distance near its zero

// Signed distances. The ellipsoid's is a first-order estimate.
double ball_distance(const Vec3& point, const Vec3& center, double radius);
double ellipsoid_distance(const Vec3& from_center, const Vec3& radii);
// The hull of two balls: a limb that tapers.
double limb_distance(const Vec3& point, const Vec3& a, double radius_a, const Vec3& b,
                     double radius_b);
// In the plane: a rectangle about the origin with half sides `half` and round corners.
double round_rectangle_distance(const Vec2& point, const Vec2& half, double rounding);
// A plate of half thickness `half` over a region of the plane, its edges rounded by `rounding`.
double plate_distance(double region, double height, double half, double rounding);

// Union and difference that blend over a width of about `soft` [m].
double smooth_union(double a, double b, double soft);
double smooth_cut(double body, double tool, double soft);

Vec3 field_gradient(const Field& field, const Vec3& point, double reach);

struct FieldMeshSettings {
    Box box;                                            // holds the body
    double sample_spacing = 0;                          // [m]; half the thinnest part or less
    double edge_length = 0;                             // [m], the shortest that is wanted
    std::function<double(const Vec3&)> edge_length_at;  // wanted at a place; empty: edge_length
    int rounds = 12;
};

// The closed surface of the body, with even triangles.
TriMesh mesh_of_field(const Field& field, const FieldMeshSettings& settings);

}  // namespace swage
