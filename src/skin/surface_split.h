// SPDX-License-Identifier: GPL-3.0-or-later
// Splits the triangles of a surface along the swept part of a blade's path and closes both sides with
// caps. Only who is whose corner is settled here; places and attributes are the caller's.
#pragma once

#include <map>
#include <vector>

#include "geometry/trimesh.h"
#include "skin/insides.h"
#include "skin/blade_path.h"

namespace swage {

// A new vertex on an edge of the old surface.
struct EdgeCut {
    int low, high;  // old vertices, low below high by number
    double share;   // of the way from low to high
};

// A cap point on the surface, where what lies inside comes to it.
struct RimPoint {
    int low, high;  // raw: old vertices or cut points of one triangle
    double share;   // of the way from low to high
};

struct SplitTriangle {
    Corners vertex;     // of the new surface
    Corners raw;        // where each comes from: old vertex, then cut point, then cap point
    int parent;         // old triangle; -1 for a cap
    bool split;         // the parent was cut
    int side;           // of the path, +1 or -1; 0 if it lies on both
    int neighbor = -1;  // of a cap: an old triangle at its rim
    int inside = -1;    // of a cap: which of the Insides it shows
};

struct SplitVertex {
    int raw;   // numbered as in SplitTriangle
    int side;  // +1 or -1; 0 where both sides share it
};

struct SurfaceSplit {
    std::vector<EdgeCut> cut;
    std::vector<Vec3> cap_point;  // [m], inside the body or on its rim, on the path
    std::map<int, RimPoint> rim;  // of those, by what they are raw
    std::vector<SplitTriangle> triangle;
    // Vertices beyond the old ones, and the side of every old one that the cut runs through.
    std::vector<SplitVertex> added;
    std::vector<SplitVertex> at_seam;
    int seam_edges = 0;
    int open_parts = 0;  // parts of the surface whose section does not close: cut, but not capped
};

// `position`: of the mesh's vertices now [m]. `spacing`: of the points inside the caps [m], whose
// edges follow what `insides` meet of the path.
SurfaceSplit split_surface(const TriMesh& mesh, const std::vector<Vec3>& position,
                           const BladePath& path, double spacing, const Insides& insides = {});

}  // namespace swage
