// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/math.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "base/portable_math.h"

namespace swage {

Vec3 Pose::operator*(const Vec3& point) const { return rotation * point + translation; }

Pose Pose::operator*(const Pose& inner) const {
    return {(rotation * inner.rotation).normalized(), rotation * inner.translation + translation};
}

Vec3 Pose::turn(const Vec3& direction) const { return rotation * direction; }

Pose Pose::inverse() const {
    const Quat back = rotation.conjugate();
    return {back, -(back * translation)};
}

Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Mat3 nearest_rotation(const Mat3& m) {
    const Eigen::JacobiSVD<Mat3> split(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 u = split.matrixU();
    if ((u * split.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
    return u * split.matrixV().transpose();
}

Vec3 solve_symmetric(const Mat3& m, const Vec3& right) { return m.ldlt().solve(right); }

// Eigen's own has a singular value decomposition in it, which takes as long to compile as all else
// here.
Quat turn_onto(const Vec3& from, const Vec3& to) {
    const Vec3 a = from.normalized(), b = to.normalized();
    const double twice = (a + b).norm();  // 2 cos of half the angle
    Quat turn;
    if (twice < 1e-6) {  // opposite ones have no plane of their own
        turn.w() = 0;
        turn.vec() = a.cross(std::abs(a.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX()).normalized();
        return turn;
    }
    turn.w() = 0.5 * twice;
    turn.vec() = a.cross(b) / twice;
    return turn;
}

Quat turn_about(const Vec3& axis, double angle) {
    Quat turn;
    turn.w() = portable::cos(0.5 * angle);
    turn.vec() = portable::sin(0.5 * angle) * axis;
    return turn;
}

Quat turn_by(const Vec3& rotation) {
    const double angle = rotation.stableNorm();
    return angle > 0 ? turn_about(rotation / angle, angle) : Quat::Identity();
}

Vec3 rotation_of(const Quat& turn) {
    const double across = turn.vec().stableNorm();
    if (!(across > 0)) return Vec3::Zero();
    const double angle = 2 * portable::atan2(across, std::abs(turn.w()));
    return (turn.w() < 0 ? -angle : angle) / across * turn.vec();
}

Vec3 turn_between(const Pose& from, const Pose& to) {
    return rotation_of((to.rotation * from.rotation.conjugate()).normalized());
}

namespace {

Vec3 axis_of(const Vec3& turn, double angle) {
    return angle > 0 ? Vec3(turn / angle) : Vec3::UnitX();
}

// Left Jacobian of the rotation group, which maps the twist's shift to the translation.
Mat3 shift_jacobian(const Vec3& axis, double theta) {
    const Mat3 k = cross_matrix(axis);
    if (std::abs(theta) < 1e-6) return Mat3::Identity() + 0.5 * theta * k;
    return Mat3::Identity() + (1 - portable::cos(theta)) / theta * k +
           (theta - portable::sin(theta)) / theta * k * k;
}

}  // namespace

Twist Twist::operator+(const Twist& other) const {
    return {turn + other.turn, shift + other.shift};
}

Twist Twist::operator-(const Twist& other) const {
    return {turn - other.turn, shift - other.shift};
}

Twist operator*(double s, const Twist& twist) { return {s * twist.turn, s * twist.shift}; }

Twist twist_between(const Pose& from, const Pose& to) {
    const Pose change = to * from.inverse();
    const Vec3 turn = turn_between(from, to);
    const double angle = turn.norm();
    return {turn, shift_jacobian(axis_of(turn, angle), angle).inverse() * change.translation};
}

Pose twisted(const Pose& from, const Twist& twist) {
    const double angle = twist.turn.norm();
    const Vec3 axis = axis_of(twist.turn, angle);
    const Pose part{turn_about(axis, angle), shift_jacobian(axis, angle) * twist.shift};
    return part * from;
}

Pose between(const Pose& from, const Pose& to, double s) {
    const Twist all = twist_between(from, to);
    const double angle = all.turn.norm();
    const Vec3 axis = axis_of(all.turn, angle);
    const Pose part{turn_about(axis, s * angle), shift_jacobian(axis, s * angle) * (s * all.shift)};
    return part * from;
}

}  // namespace swage
