// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "base/math.h"

namespace swage {

// Sums over one tool or grip; forces are those it exerts on the matter.
struct PartSum {
    using IsPlain = PartSum;
    Vec3 force = Vec3::Zero();   // [N]
    Vec3 torque = Vec3::Zero();  // about the origin of its pose [N m]
    double size = 0;             // sum of the points' force magnitudes [N]
    double penetration = 0;      // deepest [m]
    int contacts = 0;

    void add(const Vec3& arm, const Vec3& point_force) {
        force += point_force;
        torque += arm.cross(point_force);
        size += point_force.norm();
        ++contacts;
    }
    void join(const PartSum& other) {
        force += other.force;
        torque += other.torque;
        size += other.size;
        penetration = std::max(penetration, other.penetration);
        contacts += other.contacts;
    }
};

}  // namespace swage
