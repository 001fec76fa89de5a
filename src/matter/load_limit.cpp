// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/load_limit.h"

#include <cmath>

namespace swage {

double TurnAxis::torque_of(const Vec3& force, const Vec3& torque,
                           const Pose& world_from_part) const {
    const Vec3 arm = world_from_part.turn(-at);
    return world_from_part.turn(along).dot(torque + arm.cross(force));
}

double LoadLimit::borne(const Vec3& force, const Vec3& torque, const Pose& world_from_part) const {
    return of_torque ? std::abs(axis.torque_of(force, torque, world_from_part)) : force.norm();
}

}  // namespace swage
