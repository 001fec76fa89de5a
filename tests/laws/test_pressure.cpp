// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/math.h"
#include "laws/pressure.h"
#include "tests/catch.h"

using namespace swage;

namespace {

const Mat3 kGradient = (Mat3() << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.3).finished();

}  // namespace

TEST_CASE(
    "a deformed area vector is Nanson's, also where the matter is squeezed flat or mirrored") {
    const Vec3 area(0.3, -0.5, 0.7);
    const Vec3 expected = kGradient.determinant() * kGradient.inverse().transpose() * area;
    CHECK((present_area<double>(kGradient, area) - expected).norm() < 1e-14);
    Mat3 flat = kGradient;
    flat.col(2).setZero();
    const Vec3 kept = 0.7 * flat.col(0).cross(flat.col(1));
    CHECK((present_area<double>(flat, area) - kept).norm() < 1e-14);
}

TEST_CASE("pressure on the faces of a parallelepiped is the slope of p V") {
    // Each face moves with the gradient; its force works on the way of its middle.
    constexpr double kPressure = 3, kStep = 1e-6;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            Mat3 way = Mat3::Zero();
            way(row, column) = 1;
            double work = 0;
            for (int face = 0; face < 6; ++face) {
                const Vec3 normal = (face % 2 ? 1 : -1) * Vec3::Unit(face / 2);
                const Vec3 area = present_area<double>(kGradient, normal);
                work += pressure_force(kPressure, area).dot(way * (0.5 * normal));
            }
            const double slope = ((kGradient + kStep * way).determinant() -
                                  (kGradient - kStep * way).determinant()) /
                                 (2 * kStep);
            CHECK(work == Approx(-kPressure * slope).margin(1e-8));
        }
    }
}
