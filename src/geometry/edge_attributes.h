// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesh carries where its triangles are divided or parted: each value is made once for all
// who share it.
#pragma once

#include <map>

#include "geometry/trimesh.h"

namespace swage {

// Values at a new vertex on an edge, `share` of the way from its low end to the high one; of that,
// linear. `at` tells the new vertex, or those that share its values. Ends in one order, whoever
// asks.
class EdgeAttributes {
  public:
    explicit EdgeAttributes(TriMesh& mesh) : mesh_(mesh) {}

    // Ids into mesh.uv; -1 where an end has none.
    int uv(int at, int low, int high, double share);
    // Smooth groups. Theirs get a smooth_normal where both ends have one.
    int smooth(int at, int low, int high, double share);
    // Of vertices; white without colours.
    Eigen::Vector3f color(int low, int high, double share) const;

  private:
    TriMesh& mesh_;
    std::map<std::array<int, 3>, int> uv_, smooth_;
};

// Corners that shared a shading normal no longer do where their vertices parted: the first vertex
// keeps the group, others get one of their own with the same smooth_normal.
class PartedGroups {
  public:
    explicit PartedGroups(TriMesh& mesh) : mesh_(mesh) {}
    int at(int group, int vertex);

  private:
    TriMesh& mesh_;
    std::vector<int> first_;  // vertex, by group
    std::map<std::array<int, 2>, int> own_;
};

// The number of a new one.
int add_smooth_group(TriMesh& mesh, const Vec3& normal = Vec3::Zero());

}  // namespace swage
