// SPDX-License-Identifier: GPL-3.0-or-later
// What repairs need of CGAL; kept apart because its headers take a minute to compile.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// Triangles over an outline of points that close it, turning with the outline; indices into
// `outline`. Empty when no triangulation was found.
std::vector<Corners> fill_outline(const std::vector<Vec3>& outline);

// A closed surface around the triangles that enters no opening narrower than `alpha` [m] and keeps
// `offset` [m] away from them. Positions and triangles only.
TriMesh wrap_triangles(const TriMesh& mesh, double alpha, double offset);

// Cuts two closed, oriented surfaces where they meet, into patches that neither crosses. False when
// that cannot be done (a surface that crosses itself, say). Positions and triangles only.
struct CutPatches {
    TriMesh mesh;
    std::vector<int> origin;  // the triangle that each is a piece of
    std::vector<int> patch;   // of each triangle, numbered from 0
};
bool cut_along_each_other(const TriMesh& a, const TriMesh& b, CutPatches& cut_a, CutPatches& cut_b);

// Of triangles that belong to parts, one number a triangle: the pairs of parts that cross or touch,
// the lower number first, sorted. None when more than `most` pairs of triangles would have to be
// looked at.
std::optional<std::vector<std::pair<int, int>>> parts_that_meet(const TriMesh& mesh,
                                                                const std::vector<int>& part,
                                                                std::size_t most);

}  // namespace swage
