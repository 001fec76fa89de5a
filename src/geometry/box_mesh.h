// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of an axis-aligned box: twelve triangles, closed and outward.
#pragma once

#include <optional>

#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

TriMesh box_mesh(const Box& box);
inline TriMesh box_mesh(const Vec3& low, const Vec3& high) { return box_mesh(Box{low, high}); }

// That a closed surface is; none if it is not.
std::optional<Box> box_it_is(const TriMesh& mesh);

}  // namespace swage
