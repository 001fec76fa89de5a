// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors, rotations and rigid poses used everywhere. SI units; radians. Read by nearly every
// source, so what Eigen takes long to compile stands in math.cpp.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace swage {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec3i = Eigen::Vector3i;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

inline constexpr double kPi = std::numbers::pi;

// From a cell's lowest corner to corner c: bit 0 along x, bit 1 along y, bit 2 along z.
inline Vec3i corner_step(int c) { return {c & 1, c >> 1 & 1, c >> 2}; }
// To the n-th of the 27 sites around a site, itself (n = 13) among them.
inline Vec3i neighbor_step(int n) { return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}; }

// A rigid placement: `world_from_tool * point_in_tool` is a point in the world.
struct Pose {
    Quat rotation = Quat::Identity();
    Vec3 translation = Vec3::Zero();

    Vec3 operator*(const Vec3& point) const;
    Pose operator*(const Pose& inner) const;
    Vec3 turn(const Vec3& direction) const;
    Pose inverse() const;
};

Mat3 cross_matrix(const Vec3& v);

// What turns in a linear map; of one that turns inside out, the nearest that does not.
Mat3 nearest_rotation(const Mat3& m);

// Of m x = right, with m symmetric.
Vec3 solve_symmetric(const Mat3& m, const Vec3& right);

// The shortest turn that carries one direction onto another.
Quat turn_onto(const Vec3& from, const Vec3& to);

// A turn by `angle` [rad] about an axis of length 1.
Quat turn_about(const Vec3& axis, double angle);

// A turn about a rotation vector's direction by its length [rad], and back, the shorter way.
Quat turn_by(const Vec3& rotation);
Vec3 rotation_of(const Quat& turn);

// Rotation vector [rad] in the world that turns one pose's axes into another's, the shorter way.
Vec3 turn_between(const Pose& from, const Pose& to);

// A turn [rad] and a shift [m] of the world that act together, as a screw's do.
struct Twist {
    Vec3 turn = Vec3::Zero(), shift = Vec3::Zero();

    Twist operator+(const Twist& other) const;
    Twist operator-(const Twist& other) const;
    friend Twist operator*(double s, const Twist& twist);
};

// The twist that carries one pose to another, the shorter way round, and where it carries one.
Twist twist_between(const Pose& from, const Pose& to);
Pose twisted(const Pose& from, const Twist& twist);

// The pose a share `s` (0 to 1) of the way along the screw motion from one pose to another, so
// that a turn about a distant pivot stays on its arc. The turn is the shorter way round.
Pose between(const Pose& from, const Pose& to, double s);

}  // namespace swage
