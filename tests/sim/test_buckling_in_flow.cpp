// SPDX-License-Identifier: GPL-3.0-or-later
// Columns that flow before they buckle, against their tangent and their reduced modulus: what
// bears between P_t = 4 pi^2 E_t I / L^2 and P_r, of 4 E E_t / (sqrt E + sqrt E_t)^2, between fixed
// ends (Shanley, J. Aeronaut. Sci. 14, 1947).
#include <algorithm>
#include <cmath>

#include "sim/advance.h"
#include "sim/flow_aside.h"
#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1, kModulus = 1e9, kYield = 1e6;

Material metal(double tangent_modulus) {
    return {.young_modulus = kModulus,
            .poisson_ratio = 0.3,
            .yield_stress = kYield,
            .hardening = tangent_modulus / (1 - tangent_modulus / kModulus)};
}

// A square bar along x between grips, pressed together in frames.
struct Column {
    Column(int slender, int cells, const Material& material)
        : side(cells * kSpacing),
          length(slender * side),
          matter(make_block(slender * cells, cells, cells, kSpacing, material)) {
        for (double end : {-1.0, 1.0}) {
            const Vec3 at(end * 0.5 * length, 0, 0);
            Grip grip;
            grip.point = points_where(
                matter, [&](const Vec3& x) { return end * x.x() > 0.5 * length - 1e-9; });
            for (int n : grip.point) grip.anchor.push_back(matter.surface_reference(n) - at);
            apparatus.grip.push_back(grip);
            drive.world_from_grip.push_back({Quat::Identity(), at});
        }
    }

    // By a share of its length, back in the last frames. What it bears at each frame's end, over
    // its area [Pa].
    std::vector<double> press(double share, int frames, int back = 0) {
        Simulation simulation(matter, apparatus, SimSettings{});
        std::vector<double> borne;
        for (int n = 0; n < frames; ++n) {
            Drive to = drive;
            to.time += 1;
            to.world_from_grip[1].translation.x() -=
                (n < frames - back ? share : -share) * length / frames;
            const FrameReport report = simulation.advance(drive, to);
            drive = to;
            borne.push_back(std::abs(report.load[1].force.x()) / (side * side));
            bends.push_back(bend());
            is_told.push_back(std::ranges::any_of(report.warning, [](const std::string& line) {
                return line == "the work-piece buckled: it changed to another shape";
            }));
        }
        return borne;
    }
    // How far its axis has gone sideways.
    double bend() const {
        double most = 0;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            const Vec3 from = matter.particle_reference.at(p), to = matter.particle_position.at(p);
            if (std::hypot(from.y(), from.z()) < 1e-9)
                most = std::max(most, std::hypot(to.y(), to.z()));
        }
        return most;
    }

    double side, length;
    Aggregate matter;
    Apparatus apparatus;
    Drive drive;
    std::vector<double> bends{};
    std::vector<bool> is_told{};  // that it has buckled
};

double of_fixed_column(double modulus, int slender) {
    return kPi * kPi / 3 * modulus / (slender * slender);
}

}  // namespace

TEST_CASE("a column that flows buckles as its tangent modulus lets it, in few frames and in many") {
    const double tangent = 0.004 * kModulus;
    const int slender = 10;
    REQUIRE(of_fixed_column(tangent, slender) < kYield);
    std::vector<double> ends;
    for (int frames : {15, 60}) {
        Column column(slender, 4, metal(tangent));
        const std::vector<double> borne = column.press(0.03, frames);
        CAPTURE(frames);
        CHECK(*std::max_element(borne.begin(), borne.end()) < 1.05 * kYield);
        CHECK(column.bends.back() > 0.2 * column.side);
        ends.push_back(borne.back());
    }
    CHECK(ends[1] == Approx(ends[0]).epsilon(0.1));
}

TEST_CASE(
    "a column that hardens goes aside between what its tangent and its reduced modulus bear") {
    const double tangent = 0.06 * kModulus;
    const int slender = 10;
    const double least = of_fixed_column(tangent, slender);
    const double root = 1 + std::sqrt(tangent / kModulus);
    const double most = of_fixed_column(4 * tangent / (root * root), slender);
    REQUIRE(least > 1.9 * kYield);
    Column column(slender, 4, metal(tangent));
    const std::vector<double> borne = column.press(0.05, 100);
    double at = 0;  // where it has gone aside by a hundredth of its side
    for (std::size_t n = 0; n < borne.size(); ++n) {
        if (column.bends[n] > 0.01 * column.side) {
            at = borne[n];
            break;
        }
    }
    INFO(least << " to " << most);
    CHECK(at > 0.95 * least);
    CHECK(at < 1.3 * least);
    CHECK(*std::max_element(borne.begin(), borne.end()) < most);
}

TEST_CASE("what is led aside is told to have buckled once, when it has gone so far") {
    const struct {
        double tangent;
        int slender, cells, frames;
    } of[] = {{0.004, 10, 4, 15}, {0.004, 10, 4, 60}, {0.004, 20, 2, 30}, {0.01, 12, 4, 30}};
    for (const auto& [tangent, slender, cells, frames] : of) {
        Column column(slender, cells, metal(tangent * kModulus));
        column.press(0.03, frames, 4);
        CAPTURE(tangent, slender, cells, frames);
        const auto told = std::ranges::find(column.is_told, true);
        REQUIRE(told > column.is_told.begin());
        REQUIRE(told < column.is_told.end());
        const std::size_t at = told - column.is_told.begin();
        CHECK(column.bends[at] > 0.3 * kSpacing);
        CHECK(column.bends[at - 1] < 0.33 * kSpacing);
        CHECK(std::ranges::count(column.is_told, true) == 1);
    }
}

TEST_CASE("what is led aside and let go before it has gone so far is not told to have buckled") {
    Column column(10, 4, metal(0.06 * kModulus));
    column.press(0.03, 60, 6);
    const double most = *std::ranges::max_element(column.bends);
    CHECK(most > 0.15 * kSpacing);
    CHECK(most < 0.3 * kSpacing);
    CHECK(std::ranges::count(column.is_told, true) == 0);
}

TEST_CASE("what is short, or is drawn, flows on straight") {
    for (double share : {0.2, -0.05}) {
        Column column(share > 0 ? 2 : 10, 2, metal(0.01 * kModulus));
        column.press(share, 30);
        CAPTURE(share);
        CHECK(column.bends.back() < 1e-3 * column.side);
    }
}

namespace {

Vec3Array positions(const Aggregate& m, const Mat3& gradient, const Vec3Array& motion, double by) {
    Vec3Array x = motion;
    for (std::size_t p = 0; p < x.size(); ++p) {
        x.set(p, gradient * m.particle_reference.at(p) + by * motion.at(p));
    }
    return x;
}
Mat3 pressed(double strain) {
    return Vec3(std::exp(0.5 * strain), std::exp(-strain), std::exp(0.5 * strain)).asDiagonal();
}
double work_along(const Aggregate& m, const Vec3Array& motion) {
    Vec3Array force;
    LatticeForces(m).find(m, Flow::trial, force);
    double work = 0;
    for (std::size_t p = 0; p < force.size(); ++p) work += force.at(p).dot(motion.at(p));
    return work;
}

}  // namespace

TEST_CASE("modes that flow along take off a motion what they bore of it, and no more than flows") {
    const Material material = metal(0.05 * kModulus);
    Aggregate m = make_block(2, 4, 2, kSpacing, material);
    constexpr double kFirst = 0.004, kMore = 0.002, kCurve = 1;
    Vec3Array motion = m.particle_position;  // bent about z
    for (std::size_t p = 0; p < motion.size(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        motion.set(p, kCurve * Vec3(x.y() * x.y(), -2 * x.x() * x.y(), 0));
    }
    m.particle_position = positions(m, pressed(kFirst), motion, 0);
    LatticeForces(m).commit(m);
    m.particle_position = positions(m, pressed(kFirst + kMore), motion, 0);
    const FlowAside flow(m, motion);
    const double shear = kModulus / 2.6;
    const double flows = kMore / (1 + material.hardening / (3 * shear));
    CHECK(flow.as_far_as_flow() * 2.0 / 3 * kCurve * kSpacing == Approx(flows).epsilon(0.01));

    const double by = 1e-3 * flow.as_far_as_flow();
    double change = 0;
    for (double side : {by, -by}) {
        Aggregate held = m, led = m;
        led.particle_position = held.particle_position =
            positions(m, pressed(kFirst + kMore), motion, side);
        flow.commit(led, side);
        change += (work_along(led, motion) - work_along(held, motion)) / (2 * side);
    }
    CHECK(change == Approx(flow.borne()).epsilon(0.01));
}
