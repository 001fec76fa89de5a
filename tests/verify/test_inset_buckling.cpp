// SPDX-License-Identifier: GPL-3.0-or-later
// Euler's column with a stiff core: E I is the sum over what it is made of.
#include <cmath>

#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/advance.h"
#include "sim/vector_sums.h"
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

namespace {

struct Plates {
    Apparatus apparatus;
    Drive drive;  // the second is the upper one
};
Plates plates_about(const Aggregate& body, double friction) {
    const Box box = box_of(body.particle_position);
    Plates plates;
    const double height = box.high.y() - box.low.y(), wide = 3 * height;
    for (double end : {-1.0, 1.0}) {
        plates.apparatus.tool.push_back(
            {"plate", BoxShape{{wide, 0.2 * height, wide}, 0}, friction});
        const Vec3 at(0, end * 0.6 * height, 0);
        plates.drive.world_from_tool.push_back({Quat::Identity(), box.center() + at});
    }
    return plates;
}

// Pressed by so much between a smooth plate and a smooth anvil, up to `share` of its height.
struct Pressed {
    bool buckles = false;
    double turn = 0;  // [rad]
};
Pressed press_smoothly(Aggregate& body, double share, int frames) {
    const Box box = box_of(body.particle_position);
    const double height = box.high.y() - box.low.y();
    auto [apparatus, drive] = plates_about(body, 0);
    const double top = drive.world_from_tool[1].translation.y();
    Pressed pressed;
    Simulation simulation(body, apparatus, {});
    for (int frame = 1; frame <= frames; ++frame) {
        Drive to = drive;
        to.time += 1;
        const double t = double(frame) / frames, way = share * t * t * (3 - 2 * t);
        to.world_from_tool[1].translation.y() = top - way * height;
        const FrameReport report = simulation.advance(drive, to);
        drive = to;
        for (const std::string& line : report.warning) {
            pressed.buckles = pressed.buckles || line.find("buckled") != std::string::npos;
        }
    }
    Vec3 middle = Vec3::Zero();
    const double count = double(body.particle_count());
    for (std::size_t p = 0; p < body.particle_count(); ++p) {
        middle += (body.particle_position.at(p) - body.particle_reference.at(p)) / count;
    }
    Mat3 spread = Mat3::Zero();
    for (std::size_t p = 0; p < body.particle_count(); ++p) {
        const Vec3 from = body.particle_reference.at(p) - box.center();
        spread += (body.particle_position.at(p) - box.center() - middle) * from.transpose();
    }
    pressed.turn = rotation_of(Quat(nearest_rotation(spread))).norm();
    return pressed;
}

}  // namespace

TEST_CASE("a ball between smooth plates is not said to buckle where its matter could go round") {
    MoldSettings settings;
    settings.across = GENERATE(5, 7, 8);
    INFO(*settings.across << " cells across");
    Aggregate ball = mold(make_shape("sphere", {{"diameter", 0.2}, {"division", 24}}).mesh,
                          {.young_modulus = 1e6, .poisson_ratio = 0.3}, settings);
    const Pressed pressed = press_smoothly(ball, 0.3, 8);
    CHECK(!pressed.buckles);
    CHECK(pressed.turn < 0.01);
}

namespace {

// Pressed between plates with friction and let go.
struct Squeezed {
    double most = 0, stored = 0;     // force of the plate [N], energy held, at the most
    double held = 0, remainder = 0;  // of that in the end; what the books do not know of
};
Squeezed squeeze(Aggregate& body, double share, int frames) {
    const Box box = box_of(body.particle_position);
    auto [apparatus, drive] = plates_about(body, 0.2);
    const double top = drive.world_from_tool[1].translation.y();
    Squeezed squeezed;
    Simulation simulation(body, apparatus, {});
    for (int frame = 1; frame <= 2 * frames; ++frame) {
        const double there = 1 - std::abs(double(frame) / frames - 1);
        Drive to = drive;
        to.time += 1;
        to.world_from_tool[1].translation.y() = top - share * (box.high.y() - box.low.y()) * there;
        const FrameReport report = simulation.advance(drive, to);
        drive = to;
        squeezed.most = std::max(squeezed.most, report.load[1].force.norm());
        squeezed.stored = std::max(squeezed.stored, report.elastic);
        squeezed.held = report.elastic, squeezed.remainder = report.remainder;
    }
    return squeezed;
}

}  // namespace

TEST_CASE("a soft core that is crushed within its cells bears on, and gives back what it took") {
    // A sixth of each outer cell is soft: pressed to nothing before the cube is by a tenth.
    const double edge = 0.03, core = 0.58 * edge;
    const auto cube = [](double size) {
        return box_mesh(Vec3::Constant(-0.5 * size), Vec3::Constant(0.5 * size));
    };
    const Material stiff{.young_modulus = 1e6, .poisson_ratio = 0.3},
        soft{.young_modulus = 1e4, .poisson_ratio = 0.3};
    MoldSettings settings;
    settings.across = 4;
    Aggregate body = mold(cube(edge), stiff, settings, {{cube(core), soft}});
    REQUIRE(body.mixed_cell.size() == 56);
    const Squeezed squeezed = squeeze(body, 0.3, 8);
    CHECK(squeezed.most > 100);
    CHECK(squeezed.held < 1e-3 * squeezed.stored);
    CHECK(std::abs(squeezed.remainder) < 0.02 * squeezed.stored);
}
