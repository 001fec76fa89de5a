// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "matter/aggregate.h"

namespace swage {

// A point of the surface that something holds or presses on.
struct HeldPoint {
    std::array<ParticleId, 8> corner;  // as of SurfacePoints
    std::array<double, 8> weight;
    Mat3 stiffness;  // [N/m]
};

// Two places of a body that press on each other: what moves them apart, by weights whose sum is 0.
struct PressedPlaces {
    std::array<ParticleId, 16> particle;
    std::array<double, 16> weight;
    double stiffness;  // in every direction [N/m]
};

inline HeldPoint held_point(const SurfacePoints& points, int point, const Mat3& stiffness) {
    const SurfacePoints::Carriers by = points.carriers(static_cast<std::size_t>(point));
    return {by.corner, by.weight, stiffness};
}

}  // namespace swage
