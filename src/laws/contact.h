// SPDX-License-Identifier: GPL-3.0-or-later
// A point of a body's surface against a smooth rigid tool: penalty and Coulomb friction with an
// anchor (S2.5, S0.4, S0.5).
//
//     N = -k_n g                       g < 0 the signed distance to the tool [m], N [N]
//     T = k_t (I - n n^T)(anchor - x)  scaled back to |T| = mu N where it would exceed it (slip)
//
// n is the tool's outward normal. The anchor is where the point sticks, fixed to the tool; it is
// committed history, and a slipping point drags it along: anchor = x + T / k_t.
// NOTE: S0.5 has f_s > f_c; one coefficient serves for both here, because a quasi-static body has
// no sliding speed to tell them apart.
#pragma once

#include "base/math.h"

namespace swage {

struct ContactForce {
    Vec3 force = Vec3::Zero();  // on the point [N]
    double normal = 0;          // N [N]
    bool slips = false;
};

inline ContactForce contact_force(double gap, const Vec3& normal, const Vec3& point,
                                  const Vec3& anchor, double normal_stiffness,
                                  double tangential_stiffness, double friction) {
    ContactForce result;
    if (gap >= 0) return result;
    result.normal = -normal_stiffness * gap;
    const Vec3 reach = anchor - point;
    Vec3 tangential = tangential_stiffness * (reach - normal * normal.dot(reach));
    const double limit = friction * result.normal, size = tangential.norm();
    if (size > limit) {
        tangential *= limit / size;
        result.slips = true;
    }
    result.force = result.normal * normal + tangential;
    return result;
}

// -dF/dx on a flat tool [N/m]. Of a point that slips, with u = (I - n n^T)(anchor - x) and
// t = u / |u|:
//
//     k_n n n^T + mu k_n t n^T + mu N / |u| (I - n n^T - t t^T)
//
// Friction grows with the pressure, so it is not symmetric.
inline Mat3 contact_stiffness(double gap, const Vec3& normal, const Vec3& point, const Vec3& anchor,
                              double normal_stiffness, double tangential_stiffness,
                              double friction) {
    if (gap >= 0) return Mat3::Zero();
    const Mat3 across = normal * normal.transpose(), along = Mat3::Identity() - across;
    const Vec3 reach = along * (anchor - point);
    const double limit = -friction * normal_stiffness * gap, length = reach.norm();
    if (tangential_stiffness * length <= limit) {
        return normal_stiffness * across + tangential_stiffness * along;
    }
    const Vec3 way = reach / length;
    return normal_stiffness * (across + friction * way * normal.transpose()) +
           limit / length * (along - way * way.transpose());
}

// The anchor to commit: where the spring of the tangential force would begin now.
inline Vec3 dragged_anchor(const ContactForce& contact, const Vec3& normal, const Vec3& point,
                           double tangential_stiffness) {
    const Vec3 tangential = contact.force - contact.normal * normal;
    return point + tangential / tangential_stiffness;
}

}  // namespace swage
