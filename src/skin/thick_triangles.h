// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon's triangles, chosen so that none is a sliver if that can be.
#pragma once

#include <functional>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// Height of a triangle over its longest side [m].
double thickness(const Vec3& a, const Vec3& b, const Vec3& c);

// Of corners 0 to count - 1, the thinnest as thick as can be; `thickness` of a triangle of three
// corners in ascending order, below zero for one that is turned over. Takes count^3 steps.
std::vector<Corners> thick_triangles(int count,
                                     const std::function<double(int, int, int)>& thickness);

}  // namespace swage
