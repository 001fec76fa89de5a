// SPDX-License-Identifier: GPL-3.0-or-later
// Prandtl's blade: clamped at one end and loaded edgewise at the other, it tips over sideways.
#include <cmath>

#include "tests/catch.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1, kLength = 40 * kSpacing, kHeight = 5 * kSpacing, kWidth = kSpacing;
constexpr double kModulus = 1e6, kPoisson = 0.3;

// 4.013 sqrt(E I G J) / L^2; one so coarse tips over at 1.16 times that.
double prandtl() {
    const double cube = kHeight * kWidth * kWidth * kWidth;
    const double torsion = cube / 3 * (1 - 0.63 * kWidth / kHeight);
    const double shear = kModulus / (2 * (1 + kPoisson));
    return 4.013 * std::sqrt(kModulus * cube / 12 * shear * torsion) / (kLength * kLength);
}

struct Gone {
    double far;    // the loaded end, sideways, either way, as a share of the length
    long steps;    // of the solver
    bool is_told;  // that it has buckled
};

Gone goes_over(double share, int frames, double tolerance) {
    Aggregate blade =
        make_block(40, 5, 1, kSpacing, {.young_modulus = kModulus, .poisson_ratio = kPoisson});
    const auto end = [&](double side) {
        return points_where(blade,
                            [&](const Vec3& x) { return side * x.x() > 0.5 * kLength - 1e-9; });
    };
    Apparatus apparatus;
    apparatus.grip.push_back(hold(blade, end(-1)));
    apparatus.load.push_back(force_on(blade, end(1), Vec3(0, -share * prandtl(), 0)));
    SimSettings settings;
    settings.tolerance = tolerance;
    Simulation simulation(blade, apparatus, settings);
    Gone gone{};
    for (int f = 1; f <= frames; ++f) {
        const FrameReport report =
            simulation.advance(drive_of(apparatus, f - 1, double(f - 1) / frames),
                               drive_of(apparatus, f, double(f) / frames));
        gone.steps += report.iterations;
        for (const std::string& one : report.warning) {
            gone.is_told = gone.is_told || one.find("buckled") != std::string::npos;
        }
    }
    double sideways = 0;
    for (int n : end(1)) sideways += blade.surface_position(std::size_t(n)).z();
    gone.far = std::abs(sideways) / double(end(1).size()) / kLength;
    return gone;
}

}  // namespace

TEST_CASE("a blade that bears more than Prandtl's load goes over, however few its increments") {
    const Gone upright = goes_over(1.1, 5, 0.01);
    CHECK(upright.far < 1e-3);
    CHECK(!upright.is_told);
    for (double share : {1.2, 1.4, 1.6}) {
        const double far = goes_over(share, 10, 1e-4).far;
        CHECK(far > 0.15);
        for (int frames : {4, 7, 9}) {
            CAPTURE(share, frames);
            const Gone gone = goes_over(share, frames, 0.001);
            CHECK(gone.far == Approx(far).epsilon(0.01));
            CHECK(gone.is_told);
        }
    }
}

TEST_CASE("a blade that goes over comes to rest at the default tolerance too") {
    const double share = 1.3, far = goes_over(share, 10, 1e-4).far;
    for (int frames : {3, 4, 5, 6}) {
        CAPTURE(frames);
        const Gone gone = goes_over(share, frames, SimSettings{}.tolerance);
        CHECK(gone.far == Approx(far).epsilon(0.01));
        CHECK(gone.is_told);
    }
}

// It goes down a curved valley, where each straight step stretches it.
TEST_CASE("a blade goes over in few steps") {
    for (double share : {1.2, 1.4, 1.6}) {
        CAPTURE(share);
        CHECK(goes_over(share, 9, 0.01).steps < 100);
    }
}
