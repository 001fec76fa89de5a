// SPDX-License-Identifier: GPL-3.0-or-later
// A young cow, standing along x with its head towards +x and its hooves on y = 0, the same on
// both sides of z = 0. Its form and its coat are functions of a place; lengths in its own unit, of
// which it is about 1.1 long.
#pragma once

#include "base/math.h"
#include "geometry/box.h"

namespace swage {

double calf_distance(const Vec3& point);  // negative inside
Box calf_bounds();                        // holds it, with some room

// Edge length at a place in units of the length on the trunk: shorter on head, ears and feet.
double calf_edge_length(const Vec3& point);
// Share of the texture's texels a length is given at a place: 1 on the trunk.
double calf_texel_density(const Vec3& point);

// Colour of the coat in sRGB, 0 to 1, at a place on the surface with its outward normal.
Vec3 calf_color(const Vec3& point, const Vec3& normal);

// Where form and coat must agree. All on the side z > 0.
inline const Vec3 kCalfEye = {0.452, 0.757, 0.067};
inline constexpr double kCalfEyeRadius = 0.0215;
inline const Vec3 kCalfNostril = {0.592, 0.655, 0.026};
inline const Vec3 kCalfEarRoot = {0.372, 0.785, 0.062};
inline const Vec3 kCalfEarTip = {0.330, 0.772, 0.205};
inline const Vec3 kCalfHorn = {0.385, 0.838, 0.043};

}  // namespace swage
