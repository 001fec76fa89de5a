// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "sim/advance.h"
#include "sim/move_warnings.h"
#include "sim/resting_contacts.h"
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

// A block held at one end, whose other a plate presses in, by 0.8 cells if nothing else is said.
Vec3Array pressed(double thickness, int frames, double by = 0.041, double stiffness = 0,
                  int cells = 8) {
    Aggregate block = make_block(cells, 4, 4, kCell, kSpringy);
    const double half = 0.5 * kCell * cells;
    const Plate plate{thickness, -half - 0.001, by};
    Apparatus apparatus = plate.apparatus();
    Grip hold;
    hold.name = "hold";
    hold.point = points_where(block, [&](const Vec3& x) { return x.x() > half - 0.0001; });
    for (int p : hold.point) hold.anchor.push_back(block.surface_reference(p));
    apparatus.grip.push_back(hold);
    const auto at = [&](double time) {
        Drive d = plate.at(time);
        d.world_from_grip.emplace_back();
        return d;
    };
    SimSettings settings;
    settings.contact_stiffness = stiffness;
    Simulation simulation(block, apparatus, settings);
    for (int f = 0; f < frames; ++f) {
        const FrameReport report =
            simulation.advance(at(double(f) / frames), at(double(f + 1) / frames));
        CHECK(report.warning.empty());
        CHECK(report.load[0].contacts > 0);
    }
    return block.particle_position;
}

}  // namespace

TEST_CASE("what meets a tool in motion does not go through, however thin the tool is") {
    const bool plate_moves = GENERATE(false, true);
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    for (double speed : {10.0, 50.0}) {
        const Vec3Array by_thick = struck(solver, 0.2, speed, plate_moves);
        for (double thickness : {0.02, 0.0002, 1e-6, 1e-8}) {
            const Vec3Array by_thin = struck(solver, thickness, speed, plate_moves);
            CHECK(farthest_move(by_thick, by_thin) < 1e-4 * kCell);
        }
    }
}

TEST_CASE("a tool faster than any wave strikes in one frame what it strikes in many") {
    Material material = kSpringy;
    material.young_modulus = 1e4;
    const double speed = GENERATE(3.0, 30.0, 300.0);
    std::vector<double> work;
    for (const int frames : {1, 400}) {
        Aggregate block = make_block(4, 4, 4, kCell, material);
        const Plate plate{0.005, -0.15, speed};
        const Apparatus apparatus = plate.apparatus();
        Simulation simulation(block, apparatus, motion_settings());
        const double frame = 0.6 / speed / frames;
        FrameReport r;
        for (int f = 0; f < frames; ++f) {
            r = simulation.advance(plate.at(frame * f), plate.at(frame * (f + 1)));
        }
        CHECK(r.work > 0);
        work.push_back(r.work);
    }
    CHECK(work[0] == Approx(work[1]).epsilon(0.3));
}

TEST_CASE("what a tool presses rests on it alike, however thin the tool and long its way at once") {
    for (int frames : {1, 2, 10}) {
        const Vec3Array by_thick = pressed(0.2, frames);
        for (double thickness : {0.01, 0.001, 1e-5, 1e-7}) {
            CAPTURE(frames, thickness);
            CHECK(farthest_move(by_thick, pressed(thickness, frames)) < 1e-6 * kCell);
        }
    }
}

TEST_CASE("what is pressed deeper than a cell into a tool is held by it, however thin it is") {
    const double by = 0.14, soft = 0.5;
    constexpr int kShort = 3;
    for (int frames : {3, 12}) {
        const Vec3Array by_thick = pressed(0.5, frames, by, soft, kShort);
        // The first of its surface lies farther than a cell behind the plate's face.
        const double first = *std::ranges::min_element(by_thick.x);
        REQUIRE(-0.5 * kShort * kCell - 0.001 + by - first > 1.1 * kCell);
        for (double thickness : {0.11, 0.02, 1e-6}) {
            CAPTURE(frames, thickness);
            CHECK(farthest_move(by_thick, pressed(thickness, frames, by, soft, kShort)) <
                  1e-6 * kCell);
        }
    }
}

TEST_CASE("a tool that points have gone through at once is named, and one that they left is not") {
    Aggregate block = make_block(4, 4, 4, kCell, kSpringy);
    const Plate plate{1e-4, -0.09, 0};
    const Apparatus apparatus = plate.apparatus();
    const double way = GENERATE(-1.5 * kCell, -0.3 * kCell, 0.5 * kCell);
    RestingContacts contacts(block, apparatus, {});
    const Drive drive = plate.at(0);
    // It came in by 0.01, then goes on by `way`.
    const auto go = [&](double by) {
        contacts.begin_move(block, drive);
        for (double& x : block.particle_position.x) x += by;
        contacts.find_candidates(block, drive);
        contacts.commit(block, drive);
    };
    for (double& x : block.particle_position.x) x += 0.03;
    go(-0.04);
    REQUIRE(contacts.loads(block, drive)[0].contacts > 0);
    CHECK(contacts.take_pierced().empty());
    go(way);
    const bool is_through = way < -kCell;
    CHECK(contacts.take_pierced().size() == std::size_t(is_through));
    CHECK(contacts.take_pierced().empty());
    MoveOutcome outcome;
    if (is_through) outcome.pierced.push_back("plate");
    const std::vector<std::string> told = move_warnings(outcome);
    REQUIRE(told.size() == std::size_t(is_through));
    if (is_through) CHECK(told[0].find("gone through plate at once") != std::string::npos);
}

TEST_CASE("what came to be deep in a thin tool is held for one cell more, as any other") {
    Aggregate block = make_block(4, 4, 4, kCell, kSpringy);
    Apparatus apparatus;
    apparatus.tool.push_back({"plate", BoxShape{kCell * Vec3(2.8, 1.4, 2.8), 0}, 0});
    RestingContacts contacts(block, apparatus, {});
    // Its middle layer, which breaks, lies 0.6 cells below the upper side.
    Drive drive = still(0);
    drive.world_from_tool.push_back({Quat::Identity(), Vec3(0, -0.6 * kCell, 0)});
    const auto go = [&](double by) {
        contacts.begin_move(block, drive);
        for (double& y : block.particle_position.y) y -= by;
        contacts.find_candidates(block, drive);
        contacts.commit(block, drive);
        return contacts.loads(block, drive)[0];
    };
    contacts.begin_move(block, drive);
    contacts.find_candidates(block, drive);
    break_layer(block, 1);
    contacts.connections_changed(block);
    CHECK(go(0).contacts == 0);
    CHECK(go(0.05 * kCell).penetration == Approx(0.05 * kCell));
    const bool is_held = GENERATE(true, false);
    const PartSum then = go((is_held ? 0.9 : 1.1) * kCell);
    CHECK((then.contacts > 0) == is_held);
    if (is_held) CHECK(then.penetration == Approx(0.95 * kCell));
    CHECK(contacts.take_pierced().empty() == is_held);
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
    // However thin it is, and long the way: by the half that it came in by.
    for (const double thin : {1e-3, 1e-5, 1e-7, 1e-9}) {
        for (const double far : {0.5 * thin + 1e-12, 0.01, 5.0}) {
            for (const double along : {0.0, 0.4}) {
                CAPTURE(thin, far, along);
                ToolEntry anew;
                const Distance d = distance_by_entry(BoxShape{Vec3(thin, 1, 1), 0}, reach,
                                                     {far, -along, 0}, {-0.03, along, 0}, anew);
                CHECK(d.value == Approx(-0.03 - 0.5 * thin));
                CHECK(d.normal == Vec3::UnitX());
            }
        }
    }
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
