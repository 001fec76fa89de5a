// SPDX-License-Identifier: GPL-3.0-or-later
// What stands behind make_shape: a function for each shape. Length along x, thickness along y;
// the middle of the box at the origin, unless said otherwise. Materials, texture coordinates and
// smoothing are added by make_shape where a shape leaves them out.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>

#include "geometry/make_shape.h"

namespace swage {

using ShapeValues = std::map<std::string, double>;  // complete and in range

// The surface of a box divided at the given ticks along each axis (two or more, ascending), its
// positions moved by `map`. Quads in two triangles each.
TriMesh box_surface(const std::array<std::vector<double>, 3>& ticks,
                    const std::function<Vec3(const Vec3&)>& map);

// A closed band of `around` by `along` quads: position(i, j) goes round in both.
// Outward when d/dj x d/di points outward.
TriMesh ring_surface(int around, int along, const std::function<Vec3(int, int)>& position);

TriMesh make_bar(const ShapeValues& values);
TriMesh make_sheet(const ShapeValues& values);
TriMesh make_sphere(const ShapeValues& values);
TriMesh make_rod(const ShapeValues& values);
TriMesh make_tube(const ShapeValues& values);
TriMesh make_gear(const ShapeValues& values);
TriMesh make_wrench(const ShapeValues& values);
TriMesh make_plate_with_handles(const ShapeValues& values);
// With its own material, coordinates and coat; stands on y = 0.
MadeShape make_calf(const ShapeValues& values);

}  // namespace swage
