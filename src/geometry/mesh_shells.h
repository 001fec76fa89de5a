// SPDX-License-Identifier: GPL-3.0-or-later
// The closed shells of a mesh, each as a mesh of its own, and the way back.
#pragma once

#include <memory>
#include <vector>

#include "geometry/box.h"
#include "geometry/triangle_tree.h"
#include "geometry/trimesh.h"

namespace swage {

struct Shell {
    TriMesh mesh;
    Box box;
    double volume = 0;
    std::unique_ptr<TriangleTree> tree;  // made when first asked for

    double winding(const Vec3& point) {
        if (tree == nullptr) tree = std::make_unique<TriangleTree>(mesh);
        return tree->winding_number(point);
    }
};

// Parts connected through shared edges, numbered by their first triangle; one number a triangle.
// Where more than two triangles share an edge, bodies touch or cross there: those of them belong
// together that are one surface elsewhere, or one part of the file's; else those that stand
// together in the file, or that bound a wedge of matter, whichever keeps more bodies apart.
std::vector<int> shells_of(const TriMesh& mesh);

// The triangles of a closed surface, with a vertex of its own for each fan of them: it no longer
// touches itself at an edge or a vertex.
TriMesh split_fans(const TriMesh& mesh);

// One for each number in `shell`, which has one a triangle. Attributes keep their numbers; only
// positions are made few, so that many shells are cheap.
std::vector<Shell> split_shells(const TriMesh& mesh, const std::vector<int>& shell, int count);

// Puts shells together again. Their attributes still count in the whole mesh's lists.
TriMesh join_shells(const TriMesh& whole, const std::vector<const TriMesh*>& parts);

// Gives the pieces of a union what the triangles they come from had: `origin` as of unite(). New
// entries go to the lists of the whole mesh. Smooth groups only where each has its smooth_normal.
TriMesh dress_pieces(TriMesh pieces, const std::vector<int>& origin, const TriMesh& a,
                     const TriMesh& b, TriMesh& whole_mesh);

void turn_over(Shell& shell);

}  // namespace swage
