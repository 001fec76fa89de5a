// SPDX-License-Identifier: GPL-3.0-or-later
// Where blades have ended the particles of a piece: on each connection that led out of it and was
// severed, the plane of the path there. All in cells from the lattice's origin, at molding.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"
#include "matter/cut_planes.h"
#include "sim/rest_surface.h"
#include "sim/thin_near.h"

namespace swage {

class ThinEnds {
  public:
    // `site`: of the piece's particles; `number_at`: which of them is there, -1: none. What no
    // blade is known to have ended within the matter ends half-way to the next particle along an
    // axis.
    ThinEnds(const Aggregate& of, const RestSurface& molded, const ThinNear& near,
             const std::vector<Vec3i>& site, const std::function<int(const Vec3i&)>& number_at);

    // The plane, normal outward, that parts the particle from the next one that way; null: none.
    const CutPlane* toward(int number, const Vec3i& way) const;
    // All that end a particle.
    std::vector<CutPlane> of(int number) const;
    // The nearest to a place of each direction (kOneWay): of these particles, and where these have
    // none that way of those beside them. None that one of the first lies beyond, as a path that
    // ends before it does.
    std::vector<CutPlane> around(const Vec3& place, const std::vector<int>& own,
                                 const std::vector<int>& beside) const;

  private:
    struct End {
        int key;  // of the particle and the way
        CutPlane plane;
    };
    void add_nearest(const Vec3& place, const std::vector<int>& numbers,
                     const std::vector<int>& own, std::vector<CutPlane>& planes) const;
    std::pair<std::size_t, std::size_t> range_of(int number) const;

    std::vector<Vec3i> site_;
    std::vector<End> end_;  // by key
};

}  // namespace swage
