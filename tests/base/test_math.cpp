// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/math.h"

#include <limits>

#include "base/hash.h"
#include "base/portable_math.h"
#include "base/whole.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// Of numbers a and b, all over the range that states have.
template <typename Take>
void for_each_pair(Take take) {
    double a = 0.3, b = 0.7;
    for (int n = 0; n < 20000; ++n) {
        a = 3.99 * a * (1 - a);
        b = 3.97 * b * (1 - b);
        take(16 * a - 8, 16 * b - 8);
    }
}

}  // namespace

TEST_CASE("functions without an exact standard are right to the last places, and always the same") {
    Hasher hasher;
    double worst = 0;
    const auto add = [&](double got, double want) {
        worst = std::max(worst, std::abs(got / want - 1));
        hasher.add(std::span<const double>(&got, 1));
    };
    for_each_pair([&](double a, double b) {
        add(portable::sin(a), std::sin(a));
        add(portable::cos(a), std::cos(a));
        add(portable::tan(a), std::tan(a));
        add(portable::asin(a / 8), std::asin(a / 8));
        add(portable::acos(a / 8), std::acos(a / 8));
        add(portable::atan(a), std::atan(a));
        add(portable::atan2(a, b), std::atan2(a, b));
        add(portable::exp(a), std::exp(a));
        add(portable::expm1(a), std::expm1(a));
        add(portable::log(std::abs(a)), std::log(std::abs(a)));
        add(portable::log10(std::abs(a)), std::log10(std::abs(a)));
        add(portable::pow(std::abs(a), b), std::pow(std::abs(a), b));
        add(portable::hypot(a, b), std::hypot(a, b));
    });
    CHECK(worst < 5e-16);
    CHECK(hash_text(hasher.value()) == "0a5388f76c056ed8");
}

TEST_CASE("a turn by a rotation vector is that about its axis, and gives the vector back") {
    for_each_pair([&](double a, double b) {
        const Vec3 axis = Vec3(a, b, 1).normalized();
        const double angle = 0.39 * a;
        const Quat turn = turn_about(axis, angle);
        CHECK((turn.toRotationMatrix() - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm() <
              2e-15);
        CHECK((turn_by(angle * axis).coeffs() - turn.coeffs()).norm() < 1e-15);
        CHECK((rotation_of(turn) - angle * axis).norm() < 2e-15);
        CHECK((rotation_of(Quat(Eigen::Vector4d(-turn.coeffs()))) - angle * axis).norm() < 2e-15);
    });
    CHECK(turn_by(Vec3::Zero()).coeffs() == Quat::Identity().coeffs());
    CHECK(rotation_of(Quat::Identity()) == Vec3::Zero());
    CHECK((rotation_of(turn_by(Vec3(1e-200, 0, 0))) - Vec3(1e-200, 0, 0)).norm() < 1e-210);
}

TEST_CASE(
    "a twist between two poses carries one to the other, and by a share on the screw between") {
    for_each_pair([&](double a, double b) {
        const Pose from{turn_by(Vec3(a, 0.3, -b)), Vec3(b, -1, a)};
        const Pose to{turn_by(Vec3(0.2, b, a)), Vec3(1, a, -b)};
        const Twist twist = twist_between(from, to);
        const auto apart = [](const Pose& x, const Pose& y) {
            return turn_between(x, y).norm() + (x.translation - y.translation).norm();
        };
        const double far = 1 + from.translation.norm() + to.translation.norm();
        CHECK(apart(twisted(from, twist), to) < 1e-12 * far);
        CHECK(apart(twisted(from, 0.3 * twist), between(from, to, 0.3)) < 1e-12 * far);
    });
}

TEST_CASE("the rotation nearest to what is turned inside out is one all the same") {
    for_each_pair([&](double a, double b) {
        const Mat3 turn = turn_by(Vec3(a, b, 0.3)).toRotationMatrix();
        const Vec3 stretch(1.5, 1.1, 0.7);
        const auto difference = [&](const Vec3& along) {
            const Mat3 found = nearest_rotation(turn * along.asDiagonal());
            CHECK(found.determinant() == Approx(1).epsilon(1e-12));
            return (found - turn).norm();
        };
        CHECK(difference(stretch) < 1e-12);
        // Pressed through itself along its shortest side.
        CHECK(difference(stretch.cwiseProduct(Vec3(1, 1, -1))) < 1e-12);
    });
}

TEST_CASE("a turn onto a direction is the shortest, also onto the opposite one") {
    for_each_pair([&](double a, double b) {
        const Vec3 from(a, b, 1), to(-b, 2, a - 3);
        const Quat turn = turn_onto(from, to);
        const double apart = (from.normalized() + to.normalized()).norm();  // from being opposite
        CHECK((turn * from.normalized() - to.normalized()).norm() < 1e-15 + 1e-15 / apart);
        CHECK(std::abs(turn.vec().dot(from)) < 1e-14 * from.norm());
        CHECK((turn_onto(from, -from) * from + from).norm() < 1e-14 * from.norm());
    });
    for (int i = 0; i < 3; ++i) {
        const Vec3 axis = Vec3::Unit(i);
        CHECK(turn_onto(axis, axis).coeffs() == Quat::Identity().coeffs());
        CHECK(turn_onto(axis, -axis) * axis == -axis);
    }
}

#ifdef __x86_64__  // elsewhere Eigen has other sizes, but does not ask for them either
TEST_CASE("sums of products are cut the same on every machine") {
    CHECK(Eigen::l1CacheSize() == 32 << 10);
    CHECK(Eigen::l2CacheSize() == 256 << 10);
    CHECK(Eigen::l3CacheSize() == 2 << 20);
}
#endif

TEST_CASE("a number beyond all whole ones is the nearest of them") {
    constexpr int kLow = std::numeric_limits<int>::min(), kHigh = std::numeric_limits<int>::max();
    for (const double value : {0.0, -0.5, 2.9, -2.9, 1e9, -1e9, 2147483646.5, -2147483647.5}) {
        CHECK(to_int(value) == static_cast<int>(value));
    }
    for (const double value : {2147483647.0, 2147483648.0, 1e300, HUGE_VAL}) {
        CHECK(to_int(value) == kHigh);
        CHECK(to_int(-value - 1) == kLow);
    }
    CHECK(to_int(std::nan("")) == 0);
}
