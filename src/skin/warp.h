// SPDX-License-Identifier: GPL-3.0-or-later
// How rough breaks are: space is warped between the sites, so that the planes half-way between them
// are rough in the body while they are plane in straight space, where all that parts a skin is
// done.
#pragma once

#include "base/math.h"
#include "matter/lattice.h"

namespace swage {

// The same always: it hangs on the lattice alone.
class Warp {
  public:
    Warp() = default;  // none: places are as they are
    // `roughness`: as SkinSettings has it.
    Warp(const Lattice& lattice, double roughness)
        : origin_(lattice.origin), spacing_(lattice.spacing), roughness_(roughness) {}

    bool is_none() const { return roughness_ <= 0; }
    double spacing() const { return spacing_; }
    // Of a place in straight space that in the body at molding [m], and back.
    Vec3 rough(const Vec3& straight) const;
    Vec3 straight(const Vec3& place) const;
    // What a break's face is rougher by at a point of its own, by three numbers [m].
    Vec3 grain(const Vec3i& point) const;

  private:
    Vec3 origin_ = Vec3::Zero();
    double spacing_ = 1;
    double roughness_ = 0;
};

}  // namespace swage
