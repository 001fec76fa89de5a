// SPDX-License-Identifier: GPL-3.0-or-later
// The planes half-way between the particles' sites, along which a skin parts.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"

namespace swage {

inline constexpr int kNoPlane = std::numeric_limits<int>::min();

// Plane number k of an axis lies between the sites k and k + 1, off the middle by up to
// 0.06 of a spacing: so it keeps away from the mesh's vertices and lies along no face, for all that
// is cut off a triangle beside a vertex, or off a body beside a face, would be a sliver.
class MiddlePlanes {
  public:
    MiddlePlanes() = default;
    explicit MiddlePlanes(const Lattice& lattice)
        : origin_(lattice.origin), spacing_(lattice.spacing) {}

    double at(int axis, int number) const;  // [m]
    // Of one axis, before a mesh is split along its planes. The axes come one after another, for
    // what one has split has new vertices that the next keeps away from too.
    void choose(int axis, const std::vector<Vec3>& position, const std::vector<Corners>& triangle);

  private:
    struct Row {
        int first = 0;
        std::vector<double> off;  // spacings from the middle
    };
    Vec3 origin_ = Vec3::Zero();
    double spacing_ = 1;
    std::array<Row, 3> row_;
};

}  // namespace swage
