// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool or grip may bear: at it a machine comes no farther.
#pragma once

#include <cmath>
#include <cstddef>

#include "base/math.h"

namespace swage {

struct LoadLimit {
    std::size_t part = 0;  // of an apparatus: its tools, then its grips
    double most = 0;       // [N], or [N m] of a torque
    bool of_torque = false;
    // Of a torque: the axis that the part turns about, in its frame.
    Vec3 axis = Vec3::UnitZ(), at = Vec3::Zero();

    // Of what a part exerts on the matter, that which is limited: the size of its force, or of its
    // torque along the axis. `torque`: about the pose's origin.
    double borne(const Vec3& force, const Vec3& torque, const Pose& world_from_part) const {
        if (!of_torque) return force.norm();
        const Vec3 arm = world_from_part.turn(-at);
        return std::abs(world_from_part.turn(axis).dot(torque + arm.cross(force)));
    }
};

}  // namespace swage
