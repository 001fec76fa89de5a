// SPDX-License-Identifier: GPL-3.0-or-later
// How cells of springs flow that are bent and twisted by themselves, too.
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "base/math.h"
#include "laws/yield.h"
#include "matter/spring_layout.h"
#include "tests/catch.h"

using namespace swage;

namespace {

using Corners = std::array<Vec3, 8>;

Corners cube() {
    Corners x;
    for (int c = 0; c < 8; ++c) x[c] = Vec3(c & 1, c >> 1 & 1, c >> 2 & 1);
    return x;
}

Mat3 gradient_of(const Corners& x) {
    Mat3 f = Mat3::Zero();
    for (int c = 0; c < 8; ++c) {
        for (int axis = 0; axis < 3; ++axis) f.col(axis) += (c >> axis & 1 ? .25 : -.25) * x[c];
    }
    return f;
}

CellSprings<double> springs_of(const Corners& x) {
    CellSprings<double> springs;
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const CellConnection& c = kCellConnection[slot];
        const double length = c.direction < kEdgeCount ? 1 : std::sqrt(2.0);
        const Vec3 way = (x[upper_corner(c)] - x[c.corner]) / length;
        springs.way[slot] = {way.x(), way.y(), way.z()};
        springs.strain[slot] = std::log(way.norm());
    }
    return springs;
}

struct Draw {
    std::mt19937 engine{17};
    Corners corners(double far) {
        std::uniform_real_distribution<double> draw(-far, far);
        Corners x;
        for (Vec3& one : x) one = Vec3(draw(engine), draw(engine), draw(engine));
        return x;
    }
};

Corners moved(Corners x, const Corners& by, double share = 1) {
    for (int c = 0; c < 8; ++c) x[c] += share * by[c];
    return x;
}

}  // namespace

TEST_CASE("pressure of springs works by the volume alone, however a cell is bent") {
    Draw draw;
    for (int round = 0; round < 50; ++round) {
        const Corners x = moved(cube(), draw.corners(0.2)), way = draw.corners(1);
        constexpr double kStep = 1e-5;
        const Corners before = moved(x, way, -kStep), after = moved(x, way, kStep);
        const CellSprings<double> first = springs_of(before), last = springs_of(after);
        const SpringFrame<double> frame = frame_of(springs_of(x), kSpringLayout);
        double work = 0;
        for (int b = 0; b < 24; ++b) {
            work += frame.weight(b) * frame.pressure_strain(b) * (last.strain[b] - first.strain[b]);
        }
        const double grown =
            std::log(gradient_of(after).determinant() / gradient_of(before).determinant());
        CHECK(work == Approx(frame.pressure() * grown / 3).margin(1e-6 * kStep));
    }
}

TEST_CASE("springs return to the yield surface from wherever a step has taken them") {
    Draw draw;
    constexpr double kShear = 0.4, kYield = 2.5e-4;  // tin, by its modulus
    for (const double far : {0.01, 0.05, 0.1, 0.2}) {
        for (int round = 0; round < 50; ++round) {
            const Corners x = moved(cube(), draw.corners(far));
            CellSprings<double> springs = springs_of(x);
            const double theta = std::log(gradient_of(x).determinant()) / 3;
            SpringReturn<double> flow;
            REQUIRE(return_springs<double>({kYield, 0, kShear}, springs, kSpringLayout, theta, 0.0,
                                           true, flow));
            for (int b = 0; b < 24; ++b) springs.strain[b] -= flow.grows[b];
            const SpringFrame<double> frame = frame_of(springs, kSpringLayout);
            CAPTURE(far, round);
            CHECK(frame.distortion(springs.strain).stress(kShear) == Approx(kYield).epsilon(1e-6));
            CHECK(frame.pressed(frame.sums(springs.strain)) ==
                  Approx(theta).margin(1e-3 * far + 0.01 * kYield));
        }
    }
}
