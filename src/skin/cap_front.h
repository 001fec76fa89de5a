// SPDX-License-Identifier: GPL-3.0-or-later
// Caps whose two sides part. Where a blade stops inside the body the sides share the vertices; what
// has all of its vertices there would lie on its own other side.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

using Ends = std::pair<int, int>;
inline Ends ends(int a, int b) { return a < b ? Ends(a, b) : Ends(b, a); }

struct CutCaps {
    std::vector<Corners> triangle;
    std::vector<int> neighbor;  // one a triangle: of the surface, -1 away from the rim
    std::vector<int> inside;    // one a triangle
};

// `is_seam`: an edge along which the surface is cut. Triangles whose edge of a seam cannot part,
// and those that hang by nothing, are left out, their seams given to `leave`; an edge inside that
// cannot part gets the point `half_way`.
void part_caps(CutCaps& caps, const std::function<bool(const Ends&)>& is_seam,
               const std::function<void(const Ends&)>& leave,
               const std::function<int(const Ends&)>& half_way);

}  // namespace swage
