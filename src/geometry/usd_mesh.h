// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces as USD has them.
#pragma once

#include <vector>

#include "geometry/polygon.h"
#include "geometry/trimesh.h"
#include "geometry/usd_text.h"

namespace swage {

inline constexpr const char* kUsdBinds = "prepend apiSchemas = [\"MaterialBindingAPI\"]";
inline constexpr const char* kUsdOfCorners = "faceVarying";

// The values that corners have, without those that none has, and which of them each has.
struct CornerValues {
    std::vector<int> used, index;

    CornerValues(const std::vector<Corners>& ids, std::size_t count,
                 const PolygonCorners& polygons);
};
CornerValues corner_normals(const TriMesh& mesh, const PolygonCorners& polygons);
// As they are at these places.
void write_usd_normals(UsdText& out, const TriMesh& mesh, const std::vector<Vec3>& position,
                       const CornerValues& values);

// Into a prim that is open: a surface of one colour that keeps its shape. Not empty.
void write_usd_surface(UsdText& out, const TriMesh& mesh, const Vec3& color);

}  // namespace swage
