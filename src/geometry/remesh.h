// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the triangles of a closed smooth surface even: near one size, near equilateral.
#pragma once

#include <functional>
#include <vector>

#include "base/math.h"
#include "geometry/trimesh.h"

namespace swage {

struct RemeshSettings {
    // Wanted edge length [m] at a place, > 0; it may change by a third or so from one edge to the
    // next. Edges end up between about 0.7 and 1.4 of it.
    std::function<double(const Vec3&)> edge_length;
    // The nearest place on the true surface. Positions are put there after every change.
    std::function<Vec3(const Vec3&)> project;
    int rounds = 10;
    // One a triangle, or empty: kept ones stay as they are, their edges and positions included.
    std::vector<bool> keep;
};

// A mesh that lies flat where it is not kept needs no projection: pass the identity.
// The mesh must be closed, manifold and free of triangles with repeated positions; its topology
// (handles, components) is kept. Only positions and triangles come back: attributes are lost.
// Throws Error(mesh) when an edge has not exactly two triangles running along it in opposite
// directions.
TriMesh remesh(const TriMesh& mesh, const RemeshSettings& settings);

}  // namespace swage
