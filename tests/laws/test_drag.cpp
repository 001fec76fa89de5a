// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "laws/ambient_drag.h"
#include "laws/directional_drag.h"
#include "laws/internal_damping.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// Less the slope of a dissipation potential over velocity.
template <typename Potential>
Vec3 downhill(const Vec3& v, const Potential& potential) {
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 h = 1e-6 * Vec3::Unit(axis);
        slope[axis] = (potential(v - h) - potential(v + h)) / 2e-6;
    }
    return slope;
}

const Vec3 kVelocities[] = {{3, -1, 2}, {0, 0.1, 0}, {-5, 0, 1e-3}};

}  // namespace

TEST_CASE("ambient drag is the slope of its dissipation potential, and nothing at rest") {
    const AmbientDrag law{1.2, 0.5};
    constexpr double kArea = 0.3;
    for (const Vec3& v : kVelocities) {
        const auto potential = [&](const Vec3& u) {
            return 0.5 * 0.5 * 1.2 * kArea / 4 * std::pow(u.norm(), 3) / 3;
        };
        CHECK((ambient_drag_force(law, kArea, v) - downhill(v, potential)).norm() < 1e-8);
    }
    CHECK(ambient_drag_force<double>(law, kArea, Vec3::Zero()) == Vec3::Zero());
}

TEST_CASE("drag on the surface ahead stands against the motion or along the normal, none behind") {
    const Vec3 n = Vec3(1, 2, 2) / 3;
    constexpr double kArea = 0.3, kDrag = 7;
    for (const Vec3& v : kVelocities) {
        const double onward = v.dot(n);
        const Vec3 against =
            directional_drag_force<double>({kDrag, DragAlong::motion}, kArea, v, n);
        const Vec3 along = directional_drag_force<double>({kDrag, DragAlong::normal}, kArea, v, n);
        const auto potential = [&](const Vec3& u) {
            return 0.5 * kDrag * kArea * std::pow(std::max(0.0, u.dot(n)), 2);
        };
        CHECK((along - downhill(v, potential)).norm() < 1e-8);
        if (onward <= 0) {
            CHECK(against == Vec3::Zero());
        } else {
            CHECK((against + kDrag * kArea * onward * v.normalized()).norm() < 1e-12);
            CHECK(along.norm() == Approx(against.norm()));
        }
    }
}

TEST_CASE("the damping ratio holds over all decades that it is asked for") {
    for (const double ratio : {0.005, 0.02, 0.05, 0.1, 0.3}) {
        for (const double low : {300.0, 20.0, 1.0, 0.1}) {
            constexpr double kHigh = 1000;
            const DampingBranches branches = damping_branches(ratio, low, kHigh);
            for (int j = 0; j < branches.count; ++j) {
                CHECK(loss_factor(branches, 1 / branches.time[j]) ==
                      Approx(2 * ratio).epsilon(0.01));
            }
            for (double w = kHigh; w > low; w *= 0.9) {
                const double got = 0.5 * loss_factor(branches, w) / ratio;
                CHECK(got > (ratio < 0.2 ? 0.87 : 0.8));
                CHECK(got < (ratio < 0.2 ? 1.07 : 1.35));
            }
        }
    }
    CHECK(damping_branches(0, 1, 1000).count == 0);
}

TEST_CASE("a branch that is stepped loses and stores what its differential equation says") {
    const DampingBranches branches = damping_branches(0.1, 1, 1000);
    for (int j = 0; j < branches.count; ++j) {
        // Stretched steadily for a time, in one step and in a thousand.
        const double time = 1.7 * branches.time[j], strain = 0.01;
        const DampingStep whole = damping_step(branches, j, time);
        const DampingStep small = damping_step(branches, j, time / 1000);
        double m = 0;
        for (int n = 0; n < 1000; ++n) m = small.keep * m + small.gain * (strain / 1000);
        CHECK(m == Approx(whole.gain * strain));
        CHECK(m == Approx(branches.share[j] * strain / 1.7 * (1 - std::exp(-1.7))));
    }
}

TEST_CASE("the mean of a decay is what expm1 gives, to round-off, wherever it is taken") {
    CHECK(mean_decay(0) == 1);
    double worst = 0;
    for (double x = 1e-14; x < 100; x *= 1.07) {
        worst = std::max(worst, std::abs(mean_decay(x) * x / -std::expm1(-x) - 1));
    }
    CHECK(worst < 1e-15);
}
