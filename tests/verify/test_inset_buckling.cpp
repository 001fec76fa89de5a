// SPDX-License-Identifier: GPL-3.0-or-later
// Euler's column with a stiff core: E I is the sum over what it is made of.
#include <cmath>

#include "geometry/box_mesh.h"
#include "mold/mold.h"
#include "sim/advance.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.1, kSide = 3 * kSpacing, kLength = 60 * kSpacing;
constexpr double kModulus = 1e6, kCoreModulus = 41 * kModulus;

TriMesh long_box(double side) {
    const Vec3 half = 0.5 * Vec3(kLength, side, side);
    return box_mesh(-half, half);
}

double inertia(double side) { return side * side * side * side / 12; }

}  // namespace

TEST_CASE("a column with a stiff core between grips buckles at its own Euler load") {
    const double added = kCoreModulus - kModulus;
    const double bending = kModulus * inertia(kSide) + added * inertia(kSpacing);
    const double stretch = kModulus * kSide * kSide + added * kSpacing * kSpacing;
    const double critical = 4 * kPi * kPi * bending / (kLength * kLength);  // both ends clamped
    const double shortened = critical / stretch * kLength;

    MoldSettings settings;
    settings.spacing = kSpacing;
    const Material soft{.young_modulus = kModulus, .poisson_ratio = 0.3},
        stiff{.young_modulus = kCoreModulus, .poisson_ratio = 0.3};
    Aggregate column = mold(long_box(kSide), soft, settings, {{long_box(kSpacing), stiff}});
    Apparatus apparatus;
    Drive drive;
    for (double end : {-1.0, 1.0}) {
        Grip grip;
        for (std::size_t n = 0; n < column.surface.size(); ++n) {
            const Vec3 x = column.surface_reference(n);
            if (end * x.x() < 0.5 * kLength - 1e-9) continue;
            grip.point.push_back(static_cast<int>(n));
            grip.anchor.push_back(x - Vec3(end * 0.5 * kLength, 0, 0));
        }
        REQUIRE(!grip.point.empty());
        apparatus.grip.push_back(grip);
        drive.world_from_grip.push_back({Quat::Identity(), Vec3(end * 0.5 * kLength, 0, 0)});
    }
    const auto sideways = [&] {
        double most = 0;
        for (std::size_t p = 0; p < column.particle_count(); ++p) {
            const Vec3 way = column.particle_position.at(p) - column.particle_reference.at(p);
            most = std::max(most, std::hypot(way.y(), way.z()));
        }
        return most;
    };
    Simulation simulation(column, apparatus, {});
    double most = 0;
    bool told = false;
    for (int frame = 1; frame <= 8; ++frame) {
        Drive to = drive;
        const double share = 0.25 * frame;  // of what Euler's load shortens it
        to.world_from_grip[1].translation.x() = 0.5 * kLength - share * shortened;
        const FrameReport report = simulation.advance(drive, to);
        drive = to;
        most = std::max(most, std::abs(report.load[1].force.x()));
        told = told || !report.warning.empty();
        if (share <= 0.75) CHECK(sideways() < 0.01 * kSide);
        if (share >= 1.5) CHECK(sideways() > 0.1 * kSide);
    }
    CHECK(told);
    INFO("borne " << most / critical << " of Euler's load");
    CHECK(most < 1.1 * critical);
    CHECK(most > 0.9 * critical);
}
