// SPDX-License-Identifier: GPL-3.0-or-later
// Cutting polygons into triangles, and putting them together again.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/math.h"
#include "geometry/trimesh.h"

namespace swage {

// Appends corner numbers (0 .. count-1) of count-2 triangles that keep the polygon's turning sense.
// A quad is cut by the diagonal with the better triangles, a larger polygon, concave ones too, by
// ears. The first triangle starts with corner 0, and the same polygon is always cut the same way.
// Returns false when the polygon crosses itself and the result is only a best effort.
bool cut_polygon(std::span<const Vec3> corner, std::vector<Corners>& triangle);

// The two triangles of a quad, by the diagonal from its first corner or from its second.
enum class Diagonal { first, second };
inline std::array<Corners, 2> halves(const std::array<int, 4>& q, Diagonal by = Diagonal::first) {
    if (by == Diagonal::first) return {{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}};
    return {{{q[0], q[1], q[3]}, {q[1], q[2], q[3]}}};
}

// The polygons of a mesh, put together again from triangles of equal triangle_polygon. Triangles
// stay apart where they do not form one simple outline, or where the attributes of a corner differ
// between them.
struct PolygonCorners {
    std::vector<std::size_t> first = {0};  // corners of polygon p: first[p] .. first[p + 1]
    std::vector<int> corner;               // 3 * triangle + side, counter-clockwise

    std::size_t count() const { return first.size() - 1; }
};
PolygonCorners rejoin_polygons(const TriMesh& mesh);

}  // namespace swage
