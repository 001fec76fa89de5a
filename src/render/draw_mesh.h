// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as a graphics card wants it: one vertex for every different corner, triangles sorted by
// material.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

struct DrawMesh {
    struct Range {                   // triangles of one material
        int material;                // into TriMesh::material, -1 for none
        bool textured;               // all corners have texture coordinates
        std::uint32_t first, count;  // of index
    };
    // One a vertex.
    std::vector<int> vertex_position;     // into TriMesh::position
    std::vector<int> vertex_smooth;       // smooth group
    std::vector<int> vertex_uv;           // into TriMesh::uv, -1 for none
    std::vector<std::uint32_t> index;     // three a triangle
    std::vector<std::uint32_t> triangle;  // one a triangle: which of the mesh's
    std::vector<Range> range;
};

// Corners with the same position, smooth group and texture coordinate become one vertex. The mesh
// must have smooth groups. Vertices keep the order in which the triangles meet them.
DrawMesh split_corners(const TriMesh& mesh);

}  // namespace swage
