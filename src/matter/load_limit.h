// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool or grip may bear: at it a machine comes no farther.
#pragma once

#include <cstddef>

#include "base/math.h"

namespace swage {

// The axis that a part of a machine turns about, in the part's frame.
struct TurnAxis {
    using IsPlain = TurnAxis;

    Vec3 along = {0, 0, 1}, at = Vec3::Zero();

    // The part's torque about it [N m]. `torque`: about the pose's origin.
    double torque_of(const Vec3& force, const Vec3& torque, const Pose& world_from_part) const;
};

struct LoadLimit {
    std::size_t part = 0;  // of an apparatus: its tools, then its grips
    double most = 0;       // [N], or [N m] of a torque
    bool of_torque = false;
    TurnAxis axis = {};  // of a torque

    // Of what a part exerts on the matter, that which is limited: the size of its force, or of its
    // torque about the axis. `torque`: about the pose's origin.
    double borne(const Vec3& force, const Vec3& torque, const Pose& world_from_part) const;
};

}  // namespace swage
