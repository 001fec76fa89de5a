// SPDX-License-Identifier: GPL-3.0-or-later
// Where blades have gone through a body, near a place: the planes of their paths at the connections
// that they severed; where a path bends, its tangent plane at the place's foot
// (matter/bent_path.h). All in cells from the lattice's origin, in the shape at molding.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Cosine of directions that count as one: 23 degrees apart.
inline constexpr double kOneWay = 0.92;

struct CutPlane {
    Vec3 place, normal;        // unit, to either side
    Mat3 bend = Mat3::Zero();  // second derivative of what lies along the normal, by what across
    bool is_flat = true;       // it does not bend near the place

    // How far a place lies along the normal.
    double height(const Vec3& of) const;
    Vec3 slope(const Vec3& at) const { return normal - bend * (at - place); }  // of height()
    // How far it is to what lies of the path within a cell of `place`, as a blade's path ends.
    double distance(const Vec3& from) const;
};

class CutPlanes {
  public:
    explicit CutPlanes(const Aggregate& matter);

    static constexpr double kAround = 2;
    // Those that come within reach, the nearest of each of up to three directions (kOneWay); the
    // nearest first.
    std::vector<CutPlane> around(const Vec3& place, double reach = kAround) const;

    bool empty() const { return point_.empty(); }

  private:
    struct Binned {
        std::uint64_t bin;
        int point;
    };
    std::vector<CutPoint> point_;
    std::vector<Binned> binned_;  // in order
};

// The plane at which a blade has ended the matter before this face of a whole cell (2 axis + side),
// behind which no cell is whole; none where a load broke it.
std::optional<CutPlane> cut_before(const Aggregate& matter, const CutPlanes& cuts,
                                   const Vec3i& site, int face);

}  // namespace swage
