// SPDX-License-Identifier: GPL-3.0-or-later
// Euler's column: a straight bar that is shortened must not stay straight.
#include <array>
#include <cmath>

#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr int kAcross = 3, kLong = 60;
constexpr double kSpacing = 0.1, kSide = kAcross * kSpacing, kLength = kLong * kSpacing;
constexpr double kModulus = 1e6, kInertia = kSide * kSide * kSide * kSide / 12;
// Both ends clamped.
const double kCritical = 4 * kPi * kPi * kModulus * kInertia / (kLength * kLength);
const double kShortened = kCritical / (kModulus * kSide * kSide) * kLength;

struct Column {
    explicit Column(Elasticity law = Elasticity::hencky)
        : matter(make_block(kLong, kAcross, kAcross, kSpacing,
                            {.elasticity = law, .young_modulus = kModulus, .poisson_ratio = 0.3})) {
    }
    Aggregate matter;
    Apparatus apparatus;
    Drive drive;

    std::vector<int> end(double side) const {
        return points_where(matter,
                            [&](const Vec3& x) { return side * x.x() > 0.5 * kLength - 1e-9; });
    }
    void grip(double side) {
        const Vec3 at(side * 0.5 * kLength, 0, 0);
        Grip grip;
        grip.point = end(side);
        for (int n : grip.point) grip.anchor.push_back(matter.surface_reference(n) - at);
        apparatus.grip.push_back(grip);
        drive.world_from_grip.push_back({Quat::Identity(), at});
    }
    // On to this strength of its load.
    FrameReport press(Simulation& simulation, double strength) {
        Drive to = drive;
        to.time += 1;
        to.load_strength = {strength};
        const FrameReport report = simulation.advance(drive, to);
        drive = to;
        return report;
    }
    double sideways() const {
        double most = 0;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            const Vec3 way = matter.particle_position.at(p) - matter.particle_reference.at(p);
            most = std::max(most, std::hypot(way.y(), way.z()));
        }
        return most;
    }
};

// Shortened by its second grip, in quarters of what Euler's load does.
void check_buckles(Column& column) {
    Simulation simulation(column.matter, column.apparatus, {});
    double most = 0;
    bool told = false;
    for (int frame = 1; frame <= 12; ++frame) {
        Drive to = column.drive;
        const double share = 0.25 * frame;
        to.world_from_grip[1].translation.x() = 0.5 * kLength - share * kShortened;
        const FrameReport report = simulation.advance(column.drive, to);
        column.drive = to;
        most = std::max(most, std::abs(report.load[1].force.x()));
        told = told || !report.warning.empty();
        if (share <= 0.75) CHECK(column.sideways() < 0.01 * kSide);
        if (share >= 1.5) CHECK(column.sideways() > 0.3 * kSide);
    }
    CHECK(told);
    CHECK(most < 1.1 * kCritical);
    CHECK(most > 0.9 * kCritical);
}

}  // namespace

TEST_CASE("a column between grips buckles at Euler's load and bears no more") {
    for (Elasticity law : {Elasticity::hencky, Elasticity::neo_hookean, Elasticity::storakers}) {
        INFO("law " << int(law));
        Column column(law);
        for (double side : {-1.0, 1.0}) column.grip(side);
        check_buckles(column);
    }
}

TEST_CASE("pressure all round a clamped column does not buckle it") {
    Column column;
    column.grip(-1);
    Load load;
    load.name = "pressure";
    load.closed = true;
    // Ten times Euler's load on its free end.
    load.pressure = 10 * kCritical / 16 / (kSide * kSide);
    for (std::size_t n = 0; n < column.matter.surface.size(); ++n) {
        load.point.push_back(static_cast<int>(n));
    }
    column.apparatus.load.push_back(load);
    column.drive.load_strength = {0.0};
    Simulation simulation(column.matter, column.apparatus, {});
    for (int frame = 1; frame <= 5; ++frame) {
        CHECK(column.press(simulation, 0.2 * frame).warning.empty());
    }
    CHECK(column.sideways() < 0.1 * kSide);
}

TEST_CASE("a column pressed between two plates buckles too") {
    Column column;
    for (double end : {-1.0, 1.0}) {
        Tool plate{"plate", BoxShape{Vec3(1, 4, 4), 0.1}, 0.5};
        column.apparatus.tool.push_back(plate);
        column.drive.world_from_tool.push_back(
            {Quat::Identity(), Vec3(end * (0.5 * kLength + 0.5), 0, 0)});
    }
    Simulation simulation(column.matter, column.apparatus, {});
    double most = 0;
    for (int frame = 1; frame <= 10; ++frame) {
        Drive to = column.drive;
        to.world_from_tool[1].translation.x() = 0.5 * kLength + 0.5 - 0.4 * frame * kShortened;
        const FrameReport report = simulation.advance(column.drive, to);
        column.drive = to;
        most = std::max(most, std::abs(report.load[1].force.x()));
    }
    CHECK(column.sideways() > 0.3 * kSide);
    CHECK(most < 1.2 * kCritical);
}

TEST_CASE("a column that bears more than Euler's load bends to where the elastica is") {
    // Clamped at one end, with what theory gives for the way of the other: P / P_0 = (2 K / pi)^2,
    // sideways 2 k L / K, with K(k) the complete elliptic integral.
    const double share = GENERATE(1.2, 1.5), aside = GENERATE(0.0, 1e-4);
    CAPTURE(share, aside);
    Column column;
    column.grip(-1);
    Load load;
    load.name = "push";
    load.point = column.end(1);
    const double critical = kCritical / 16, push = share * critical;
    load.force.assign(load.point.size(), Vec3(-push, aside * push, 0) / double(load.point.size()));
    column.apparatus.load.push_back(load);
    column.drive.load_strength = {0.0};
    Simulation simulation(column.matter, column.apparatus, {});
    for (int frame = 1; frame <= 10; ++frame) column.press(simulation, 0.1 * frame);
    double low = 0, high = 1;  // of k^2
    for (int round = 0; round < 60; ++round) {
        const double middle = 0.5 * (low + high);
        const double ratio = 2 / kPi * std::comp_ellint_1(std::sqrt(middle));
        (ratio * ratio < share ? low : high) = middle;
    }
    const double k = std::sqrt(low), theory = 2 * k * kLength / std::comp_ellint_1(k);
    const Vec3Array& x = column.matter.particle_position;
    const std::size_t last = x.size() - 1;
    CHECK(std::hypot(x.y[last], x.z[last]) == Approx(theory).epsilon(0.03));
}

TEST_CASE("what nothing bears on does not buckle") {
    Aggregate block =
        make_block(4, 4, 4, 0.1, {.young_modulus = 1e6, .poisson_ratio = 0.3, .yield_stress = 1e4});
    Apparatus press;
    press.name = "press";
    Drive drive;
    for (double end : {-1.0, 1.0}) {
        press.tool.push_back({"plate", BoxShape{Vec3(2, 1, 2), 0}, 0.3});
        drive.world_from_tool.push_back({Quat::Identity(), Vec3(0, end * 0.7, 0)});
    }
    Simulation simulation(block, press, {});
    for (double depth : {0.05, 0.1, 0.1, 0.05, 0.0, -0.05}) {
        Drive to = drive;
        to.time += 1;
        to.world_from_tool[1].translation.y() = 0.7 - depth;
        CHECK(simulation.advance(drive, to).warning.empty());
        drive = to;
    }
}

TEST_CASE("a leg gives way although a longer one beside it, which bears what it can, is softer") {
    const int before = GENERATE(0, 33);  // increments in which only that one is loaded
    constexpr int kShort = 20, kLonger = 26, kBase = 2;
    const Vec3i foot(9, 1, kBase), longer_foot(1, 1, kBase), count(12, 3, kBase + kLonger);
    std::vector<Vec3i> cells;
    for (int k = 0; k < kBase; ++k) {
        for (int j = 0; j < count.y(); ++j) {
            for (int i = 0; i < count.x(); ++i) cells.emplace_back(i, j, k);
        }
    }
    for (int k = 0; k < kLonger; ++k) {
        cells.emplace_back(longer_foot + k * Vec3i::UnitZ());
        if (k < kShort) cells.emplace_back(foot + k * Vec3i::UnitZ());
    }
    Aggregate matter =
        make_matter(Vec3::Zero(), kSpacing, count, cells, std::vector<float>(cells.size(), 1.0f),
                    {.young_modulus = kModulus, .poisson_ratio = 0.3, .density = 1000});
    // A bar that is clamped at its foot and free at its head.
    const auto bears = [](int cells_long) {
        const double a = kSpacing, length = cells_long * a;
        return kPi * kPi * kModulus * a * a * a * a / 12 / (4 * length * length);
    };
    Apparatus apparatus;
    apparatus.load.resize(2);
    const std::array<Vec3i, 2> head{foot + (kShort - 1) * Vec3i::UnitZ(),
                                    longer_foot + (kLonger - 1) * Vec3i::UnitZ()};
    Grip base;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto add = [&](const Vec3& side) {
            matter.surface.add(matter.lattice.cell_row(CellId(c)), Vec3::Constant(0.5) + 0.5 * side,
                               kSpacing * kSpacing, side);
            return int(matter.surface.size()) - 1;
        };
        if (cells[c].z() == 0) {
            base.point.push_back(add(-Vec3::UnitZ()));
            base.anchor.push_back(matter.surface_reference(base.point.back()));
        }
        if (cells[c].z() < kBase) continue;
        for (int d : {0, 1}) {
            for (double side : {-1.0, 1.0}) add(side * Vec3::Unit(d));
        }
        for (std::size_t leg = 0; leg < 2; ++leg) {
            if (cells[c] != head[leg]) continue;
            apparatus.load[leg].point = {add(Vec3::UnitZ())};
            apparatus.load[leg].force = {Vec3(0, 0, -bears(leg == 0 ? kShort : kLonger))};
        }
    }
    apparatus.grip.push_back(base);
    Drive drive;
    drive.world_from_grip.assign(1, Pose{});
    drive.load_strength = {0, 0};
    Simulation simulation(matter, apparatus, {});
    bool told = false;
    for (int frame = 1 - before; frame <= 4; ++frame) {
        Drive to = drive;
        to.time += 1;
        to.load_strength = {0.3 * std::max(frame, 0), 0.8};
        told = !simulation.advance(drive, to).warning.empty();
        CHECK(told == (frame == 4));
        drive = to;
    }
}
