// SPDX-License-Identifier: GPL-3.0-or-later
// A binary tree of boxes over the triangles of a surface: what is nearest, how far it is, what
// stands in the way, and the winding number.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/trimesh.h"

namespace swage {

class TriangleTree {
  public:
    // Keeps copies of the corners; the mesh may go. Needs at least one triangle.
    explicit TriangleTree(const TriMesh& mesh);

    // Unsigned distance [m] from `point` to the nearest triangle.
    double distance(const Vec3& point) const;

    struct Nearest {
        int triangle;  // of the mesh
        Vec3 weight;   // of its corners, each 0 to 1: their mean is the nearest place
    };
    Nearest nearest(const Vec3& point) const;

    // Whether any triangle lies between the two points.
    bool lies_between(const Vec3& from, const Vec3& to) const;

    // How often the surface winds around `point`: 1 inside a closed outward surface, 0 outside,
    // between the two near the holes of an open one. Accurate to about 0.02.
    double winding_number(const Vec3& point) const;

  private:
    struct Node {
        Box box;
        Vec3 area = Vec3::Zero();    // sum of the triangles' area vectors
        Vec3 centre = Vec3::Zero();  // mean of their centroids, weighted by area
        double radius = 0;           // of a ball about the centre that holds them all
        int left = -1, right = -1;   // children; -1 in a leaf
        int first = 0, count = 0;    // triangles
    };
    struct Found {
        int at;  // in triangle_
        double squared_distance;
    };
    Found find(const Vec3& point) const;
    int build(std::vector<int>& order, const std::vector<Vec3>& centroid, int first, int count);

    std::vector<std::array<Vec3, 3>> triangle_;  // in the order of the leaves
    std::vector<int> number_;                    // of each in the mesh
    std::vector<Node> node_;                     // node 0 is the root
};

}  // namespace swage
