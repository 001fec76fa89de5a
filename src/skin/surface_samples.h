// SPDX-License-Identifier: GPL-3.0-or-later
// The true surface of the body at molding, as the points that the matter carries of it.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

class SurfaceSamples {
  public:
    explicit SurfaceSamples(const Aggregate& matter);

    bool empty() const { return matter_.surface.size() == 0; }
    // Puts a place onto the surface, if there is any within reach (about a spacing and a half).
    // `facing`: about outward, so that the far side of a thin part does not count. `normal` becomes
    // the mean normal there.
    bool project(const Vec3& facing, Vec3& place, Vec3& normal) const;

  private:
    const Aggregate& matter_;
    std::vector<int> first_;  // a cell each and one more: into sample_
    std::vector<int> sample_;
};

}  // namespace swage
