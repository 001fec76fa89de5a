// SPDX-License-Identifier: GPL-3.0-or-later
// Changes to a mesh that keep all its arrays in step.
#pragma once

#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// Leaves out the triangles t with keep[t] == 0.
void keep_triangles(TriMesh& mesh, const std::vector<char>& keep);

// Turns the triangle over.
void flip_triangle(TriMesh& mesh, std::size_t triangle);

// Adds a triangle that looks like triangle `like` (material, part), without texture coordinates.
// `smooth` are its smooth groups; used only when the mesh has any.
void add_triangle(TriMesh& mesh, const Corners& corners, std::size_t like, const Corners& smooth);

// Leaves out positions, with their colours, that no triangle uses.
void drop_unused_positions(TriMesh& mesh);

}  // namespace swage
