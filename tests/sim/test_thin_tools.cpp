// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"
#include "sim/tool_entry.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.05;

// A plate whose face on the block's side begins at `face` and goes on along x at this speed.
struct Plate {
    double thickness, face, speed;

    Apparatus apparatus() const {
        Apparatus a;
        a.name = "plate";
        a.tool.push_back({"plate", BoxShape{Vec3(thickness, 1, 1), 0}, 0.3});
        return a;
    }
    Drive at(double time) const {
        Drive d = still(time);
        const double x = face + speed * time - thickness / 2;
        d.world_from_tool.push_back({Quat::Identity(), Vec3(x, 0, 0)});
        return d;
    }
};

// A block and a plate that meet at this speed.
Vec3Array struck(Solver solver, double thickness, double speed, bool plate_moves) {
    Material material = kSpringy;
    material.young_modulus = 1e7;
    material.damping_ratio = 0.1;
    Aggregate block = make_block(4, 4, 4, kCell, material);
    if (!plate_moves) {
        for (double& v : block.particle_velocity.x) v = -speed;
    }
    const Plate plate{thickness, -0.15, plate_moves ? speed : 0};
    const Apparatus apparatus = plate.apparatus();
    Simulation simulation(block, apparatus, motion_settings(solver));
    const double frame = 0.02 / speed;
    for (int f = 0; f < 12; ++f) {
        simulation.advance(plate.at(frame * f), plate.at(frame * (f + 1)));
        const double back =
            plate.face + plate.speed * frame * (f + 1) - std::max(thickness, 0.5 * kCell);
        for (double x : block.particle_position.x) CHECK(x > back);
    }
    return block.particle_position;
}

// A block held at one end, whose other a plate presses in by 0.8 cells.
Vec3Array pressed(double thickness, int frames) {
    Aggregate block = make_block(8, 4, 4, kCell, kSpringy);
    const Plate plate{thickness, -0.201, 0.041};
    Apparatus apparatus = plate.apparatus();
    Grip hold;
    hold.name = "hold";
    hold.point = points_where(block, [](const Vec3& x) { return x.x() > 0.1999; });
    for (int p : hold.point) hold.anchor.push_back(block.surface_reference(p));
    apparatus.grip.push_back(hold);
    const auto at = [&](double time) {
        Drive d = plate.at(time);
        d.world_from_grip.emplace_back();
        return d;
    };
    Simulation simulation(block, apparatus, {});
    for (int f = 0; f < frames; ++f) {
        simulation.advance(at(double(f) / frames), at(double(f + 1) / frames));
    }
    return block.particle_position;
}

}  // namespace

TEST_CASE("what meets a tool in motion does not go through, however thin the tool is") {
    const bool plate_moves = GENERATE(false, true);
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    for (double speed : {10.0, 50.0}) {
        const Vec3Array by_thick = struck(solver, 0.2, speed, plate_moves);
        for (double thickness : {0.02, 0.0002}) {
            const Vec3Array by_thin = struck(solver, thickness, speed, plate_moves);
            CHECK(farthest_move(by_thick, by_thin) < 1e-4 * kCell);
        }
    }
}

TEST_CASE("what a tool presses rests on it alike, however thin the tool and long its way at once") {
    for (int frames : {2, 10}) {
        const Vec3Array by_thick = pressed(0.2, frames);
        for (double thickness : {0.01, 0.001}) {
            CHECK(farthest_move(by_thick, pressed(thickness, frames)) < 1e-6 * kCell);
        }
    }
}

TEST_CASE("a point is held by the side of a tool that it came in by, until it has slid off it") {
    const Shape plate = BoxShape{Vec3(0.01, 1, 1), 0};
    const EntryReach reach{0.0125, 0.1};
    ToolEntry entry;
    const auto at = [&](const Vec3& from, const Vec3& now) {
        return distance_by_entry(plate, reach, from, now, entry);
    };
    // In from the right, and on to behind the plate.
    CHECK(at({0.01, 0, 0}, {0.004, 0, 0}).value == Approx(-0.001));
    for (double x : {0.001, -0.003, -0.02}) {
        const Distance d = at({0.01, 0, 0}, {x, 0, 0});
        CHECK(d.value == Approx(x - 0.005));
        CHECK(d.normal == Vec3::UnitX());
    }
    CHECK(at({0.01, 0, 0}, {-0.02, 0.51, 0}).value == Approx(-0.025));
    CHECK(at({0.01, 0, 0}, {-0.02, 0.52, 0}).value > 0);  // past its edge: free
    CHECK(entry.normal.isZero());
    // Through it at once; and past it.
    CHECK(at({0.02, 0, 0}, {-0.03, 0, 0}).value == Approx(-0.035));
    entry = {};
    CHECK(at({0.02, 0.6, 0}, {-0.03, 0.6, 0}).value > 0);
    entry = {};
    CHECK(at({0.02, 0, 0}, {-0.2, 0, 0}).value > 0);  // too far
    // From the left it is the other side.
    CHECK(at({-0.01, 0, 0}, {0.003, 0, 0}).value == Approx(-0.008));
}

TEST_CASE(
    "a point whose way cuts a bend of a tool, and ends outside on that side, does not touch it") {
    const Shape wire = CylinderShape{0.01, 1};
    const EntryReach reach{0.0125, 0.1};
    const double high = 0.0095, wide = 0.0035;  // its ends lie outside, its middle inside
    ToolEntry entry;
    const Vec3 from(-wide, high, 0), now(wide, high, 0);
    REQUIRE(distance_to(wire, now).value > 0);
    REQUIRE(distance_to(wire, {0, high, 0}).value < 0);
    const double far = 8;  // times as long, as of what went on along the tool
    const Distance d = distance_by_entry(wire, reach, Vec3(-far * wide, high, 0), now, entry);
    CHECK(d.value == Approx(distance_to(wire, now).value));
    CHECK(entry.normal.isZero());
    // All through it, it does.
    CHECK(distance_by_entry(wire, reach, {0, 0.02, 0}, {0, -0.02, 0}, entry).value < 0);
}
