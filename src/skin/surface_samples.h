// SPDX-License-Identifier: GPL-3.0-or-later
// The true surface of the body at molding, as the points that the matter carries of it.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

class SurfaceSamples {
  public:
    explicit SurfaceSamples(const Aggregate& matter);

    bool empty() const { return sample_.empty(); }
    // Puts a place onto the surface, if there is any within reach (about a spacing and a half).
    // `facing`: about outward, so that the far side of a thin part does not count. `normal` becomes
    // the mean normal there.
    bool project(const Vec3& facing, Vec3& place, Vec3& normal) const;
    // How far a place near the surface lies outside it, by the planes of the samples around, in
    // spacings; negative inside, and kNone where there is no surface near.
    static constexpr double kNone = -1.5;
    double height(const Vec3& place) const;
    // Brings a place that lies higher than that down to it.
    void lower(double most, Vec3& place) const;

  private:
    struct Sample {
        Vec3 place;  // in spacings from the lattice's origin
        Vec3 normal;
    };
    // `normal`: becomes that of the plane that tells it.
    double height(const Vec3& place, Vec3& normal) const;
    // Calls f(sample, way from it, squared distance) for those within `reach`, in spacings.
    template <typename F>
    void for_each_near(const Vec3& at, double reach, const F& f) const;

    const Lattice& lattice_;
    std::vector<int> first_;  // a cell each and one more: into sample_
    std::vector<Sample> sample_;
};

}  // namespace swage
