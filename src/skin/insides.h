// SPDX-License-Identifier: GPL-3.0-or-later
// What lies inside a body, as a blade that goes through it lays it open.
#pragma once

#include <array>
#include <vector>

#include "geometry/triangle_tree.h"
#include "geometry/trimesh.h"
#include "skin/blade_path.h"

namespace swage {

// Closed surfaces of other matter, uncut, where they are now. Of those that overlap the last
// counts.
class Insides {
  public:
    // `look`: of cut faces that show it.
    void add(TriMesh surface, SurfaceMaterial look);
    bool empty() const { return surface_.empty(); }
    const SurfaceMaterial& look(int number) const { return look_[number]; }

    // Where they all meet a path, whether one blade reaches it or not.
    std::vector<std::array<Vec2, 2>> lines_in(const BladePath& path) const;
    // The number, from 0, of what lies at a point; -1: the body itself.
    int at(const Vec3& point) const;

  private:
    std::vector<TriMesh> surface_;
    std::vector<TriangleTree> tree_;
    std::vector<SurfaceMaterial> look_;
};

}  // namespace swage
