// SPDX-License-Identifier: GPL-3.0-or-later
// A skin bends only at its vertices: a mesh of few and long edges, as a CAD program writes flat
// faces, could not follow its matter.
#pragma once

#include <functional>

#include "geometry/trimesh.h"
#include "skin/surface_split.h"

namespace swage {

// The mesh with no edge above `longest` [m]: edges are halved, the longest first, so that triangles
// do not grow thinner. The surface is the same and as closed as it was; what it carries (texture
// coordinates, smoothing, colours, materials, parts) goes on linearly. Old vertices keep their
// numbers, and a mesh without such edges is left as it is.
TriMesh divide_edges(const TriMesh& mesh, double longest);

// Of a triangle's, or a mesh's, longest edge: those above are halved with it, so that a triangle's
// longest is halved before its others.
inline constexpr double kNearLongest = 0.7;

// Halves those edges, of which the lower vertex comes first, at once. `halved`: what each new
// vertex halves, in their order. Its smooth groups are to have their normals.
TriMesh halve_edges(const TriMesh& mesh, const std::function<bool(int, int)>& is_long,
                    std::vector<EdgeCut>& halved);

}  // namespace swage
