// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <random>

#include "sim/advance.h"
#include "sim/crumbs.h"
#include "sim/lattice_forces.h"
#include "sim/sever.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/flying_block.h"
#include "tests/sim/motion.h"
#include "tests/sim/pulled_bar.h"

using namespace swage;
using namespace swage::test;

namespace {

// A blade wide enough for the block, edge along y', moving along z' of a frame whose x' is normal.
void cut_along(Aggregate& m, const Vec3& point, const Vec3& normal, double reach, int sweeps) {
    const Quat world_from_plane = turn_onto(Vec3::UnitX(), normal.normalized());
    const Blade blade{"blade", {Vec3(0, -reach, 0), Vec3(0, reach, 0)}, {}};
    for (int s = 0; s < sweeps; ++s) {
        const auto pose = [&](int step) {
            return Pose{world_from_plane,
                        point + world_from_plane * Vec3(0, 0, reach * (2.0 * step / sweeps - 1))};
        };
        sever(m, crossed_connections(m, swept_triangles(blade, pose(s), pose(s + 1))));
    }
}

// A floor, and a blade that has come so far along x.
Drive cut_at(double time, double x) {
    Drive d = floor_at(time);
    d.world_from_blade = {Pose{Quat::Identity(), Vec3(x, 0, 0)}};
    return d;
}

// With weight, on soft contacts.
SimSettings lying(Solver solver, double contact_stiffness) {
    SimSettings settings = motion_settings(solver);
    settings.gravity = Vec3(0, -9.81, 0);
    settings.contact_stiffness = contact_stiffness;
    settings.sleep = false;
    return settings;
}

const Material kPad{
    .young_modulus = 1e6, .density = 1000, .damping_ratio = 0.3, .friction = 0.5, .restitution = 0};

}  // namespace

TEST_CASE("of blades that cross the same connections one severs them") {
    const Aggregate m = make_block(10, 4, 4, 0.1, Material{});
    Apparatus apparatus;
    Drive from, to;
    // Two between the same layers of particles, sloping, and one between others.
    for (const double x : {0.03, 0.06, 0.23}) {
        apparatus.blade.push_back({"blade", {Vec3(x, -.1, -1), Vec3(x, .1, 1)}, {}});
        from.world_from_blade.push_back({Quat::Identity(), Vec3(0, 1, 0)});
        to.world_from_blade.push_back({Quat::Identity(), Vec3(0, -1, 0)});
    }
    Drive between = from;
    between.world_from_blade[1] = to.world_from_blade[1];
    // Whether the second falls with the first or before it.
    for (const auto& way : {std::vector{from, to}, std::vector{from, between, to}}) {
        std::vector<SeverEvent> events = crossed_connections(m, swept_triangles(apparatus, way));
        name_blades(events, m, apparatus, way);
        std::array<std::size_t, 3> count{};
        for (const SeverEvent& e : events) ++count[std::size_t(e.blade)];
        CHECK(count[0] > 0);
        CHECK(count[1] == 0);
        CHECK(count[2] == count[0]);
    }
}

TEST_CASE("any plane through a body leaves exactly two pieces, however it meets the lattice") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < 120; ++trial) {
        Aggregate m = make_block(10, 6, 6, 0.1, Material{});
        Vec3 normal(unit(random), unit(random), unit(random));
        Vec3 point(0.3 * unit(random), 0.2 * unit(random), 0.2 * unit(random));
        if (trial % 2 == 0) {
            // Through particles, along faces and diagonals of the cells.
            const auto third = [&] { return std::round(1.4 * unit(random)); };
            do normal = Vec3(third(), third(), third());
            while (normal.norm() == 0);
            point = 0.05 * Vec3(std::round(4 * unit(random)), std::round(2 * unit(random)),
                                std::round(2 * unit(random)));
        }
        const int sweeps = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 7 : 23;
        cut_along(m, point, normal, 3, sweeps);
        CHECK(find_pieces(m).count == 2);
    }
}

TEST_CASE("a blade that misses, or rests, severs nothing") {
    Aggregate m = make_block(4, 4, 4, 0.1, Material{});
    const std::size_t all = m.connection_count();
    cut_along(m, Vec3(0.5, 0, 0), Vec3::UnitX(), 3, 4);
    const Blade blade{"blade", {Vec3(0, -1, 0), Vec3(0, 1, 0)}, {}};
    CHECK(crossed_connections(m, swept_triangles(blade, Pose{}, Pose{})).empty());
    CHECK(m.connection_count() == all);
}

TEST_CASE("half a sweep severs only what the blade has passed") {
    Aggregate m = make_block(8, 4, 4, 0.1, Material{});
    const Blade blade{"blade", {Vec3(0.01, 0, -1), Vec3(0.01, 0, 1)}, {}};
    const auto pose = [](double y) { return Pose{Quat::Identity(), Vec3(0, y, 0)}; };
    const auto events = crossed_connections(m, swept_triangles(blade, pose(1), pose(0.001)));
    sever(m, events);
    CHECK_FALSE(events.empty());
    CHECK(find_pieces(m).count == 1);
    for (const SeverEvent& e : events) {
        CHECK(m.connection[e.direction].weight[e.lower] == 0);
        CHECK(e.weight > 0);
        CHECK(m.particle_reference.at(e.lower).y() > -0.11);
    }
    sever(m, crossed_connections(m, swept_triangles(blade, pose(0.001), pose(-1))));
    CHECK(find_pieces(m).count == 2);
}

TEST_CASE("pieces part freely: a severed half follows its grip and feels no force") {
    Aggregate m = make_block(8, 2, 2, 0.1, Material{});
    Apparatus apparatus;
    apparatus.name = "cut";
    apparatus.grip = end_grips(m, 0.3);
    apparatus.blade.push_back({"blade", {Vec3(0.02, 0, -1), Vec3(0.02, 0, 1)}, {}});
    const auto drive = [](double y, double pull) {
        Drive d;
        d.world_from_grip = {Pose{}, Pose{Quat::Identity(), Vec3(pull, 0, 0)}};
        d.world_from_blade = {Pose{Quat::Identity(), Vec3(0, y, 0)}};
        return d;
    };
    const SimSettings settings;
    Simulation simulation(m, apparatus, settings);
    FrameReport r = simulation.advance(drive(0.5, 0), drive(-0.5, 0));
    CHECK(r.severed > 0);
    CHECK(r.pieces == 2);
    r = simulation.advance(drive(-0.5, 0), drive(-0.5, 0.25));
    const double scale = m.material.young_modulus * 0.01;
    for (const ToolLoad& load : r.load) CHECK(load.force.norm() < 1e-9 * scale);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 moved = m.particle_position.at(p) - m.particle_reference.at(p);
        const double wanted = m.particle_reference.at(p).x() > 0.01 ? 0.25 : 0;
        CHECK((moved - Vec3(wanted, 0, 0)).norm() < 0.01);
    }
}

TEST_CASE("what a cut or an opened grip lets go of is set free, not left over by the books") {
    const bool cuts = GENERATE(true, false);
    Aggregate m = make_block(12, 2, 2, 0.1, Material{.young_modulus = 1e6, .poisson_ratio = 0.3});
    const auto gripped = [&](std::initializer_list<int> sides) {
        Apparatus a;
        a.name = "stretch";
        for (int side : sides) {
            Grip grip;
            grip.name = side < 0 ? "hold" : "pull";
            grip.point = points_where(m, [&](const Vec3& x) { return side * x.x() > 0.5; });
            for (int p : grip.point) grip.anchor.push_back(m.surface_reference(p));
            a.grip.push_back(grip);
        }
        return a;
    };
    Drive drive;
    drive.world_from_grip = {Pose{}, Pose{}};
    drive.world_from_blade = {Pose{Quat::Identity(), Vec3(0, 0.5, 0)}};
    const auto on = [&](double pull, double blade) {
        Drive to = drive;
        to.time += 1;
        to.world_from_grip.back().translation.x() = pull;
        to.world_from_blade[0].translation.y() = blade;
        return to;
    };
    SimSettings settings;
    settings.tolerance = 1e-4;
    Apparatus both = gripped({-1, 1});
    both.blade.push_back({"blade", {Vec3(0.02, 0, -1), Vec3(0.02, 0, 1)}, {}});
    Simulation simulation(m, both, settings);
    FrameReport r;
    for (double pull : {0.01, 0.02, 0.03, 0.04, 0.05}) {
        const Drive next = on(pull, 0.5);
        r = simulation.advance(drive, next);
        drive = next;
    }
    const double stored = r.elastic;
    REQUIRE(stored > 1);
    CHECK(std::abs(r.remainder) < 0.01 * stored);
    CHECK(r.set_free == 0);
    if (cuts) {
        r = simulation.advance(drive, on(0.07, -0.5));  // it pulls on while it is cut
        CHECK(r.pieces == 2);
        CHECK(r.set_free + r.severed_energy > 0.9 * stored);
    } else {
        const Apparatus one = gripped({-1});
        Drive from;
        from.world_from_grip = {Pose{}};
        Drive to = from;
        to.time = 1;
        to.world_from_grip[0].translation.x() = 0.05;
        Simulation after(m, one, settings);
        r = after.advance(from, to);
        CHECK(r.set_free == Approx(stored).epsilon(0.05));
    }
    CHECK(std::abs(r.remainder) < 0.01 * stored);
}

TEST_CASE("what a blade has cut through is at rest where it lay, however it had flowed") {
    Aggregate m = make_block(
        8, 4, 4, 0.1, Material{.young_modulus = 1e6, .poisson_ratio = 0.3, .yield_stress = 1e4});
    LatticeForces lattice(m);
    Vec3Array force;
    force.resize(m.particle_count());
    std::mt19937 random(7);
    std::uniform_real_distribution<double> off(-0.02, 0.02);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_position.set(p, x + Vec3(off(random), off(random), off(random)));
    }
    lattice.find(m, Flow::trial, force);
    lattice.commit(m);
    const double held = lattice.elastic_energy(m);
    for (double x : {-0.05, 0.05}) cut_along(m, Vec3(x, 0, 0), Vec3::UnitX(), 2, 1);
    REQUIRE(find_pieces(m).count == 3);
    const auto pull_between = [&](LatticeForces& forces) {  // the cuts, where no cell is whole
        forces.find(m, Flow::trial, force);
        double most = 0;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            if (m.particle_reference.at(p).x() == 0) most = std::max(most, force.at(p).norm());
        }
        return most;
    };
    LatticeForces as_it_flowed(m);
    REQUIRE(pull_between(as_it_flowed) > 1);
    lattice.connections_changed(m, true);
    CHECK(pull_between(lattice) < 1e-3);
    CHECK(lattice.elastic_energy(m) < held);
}

TEST_CASE("a crumb between two cuts stays with one side and does not join them") {
    Aggregate m = make_block(6, 1, 1, 0.1, Material{});
    Apparatus apparatus;
    apparatus.name = "cut";
    for (double x : {-0.03, 0.04}) {
        apparatus.blade.push_back({"blade", {Vec3(x, 0, -1), Vec3(x, 0, 1)}, {}});
    }
    const auto drive = [](double y) {
        Drive d;
        d.world_from_blade.assign(2, Pose{Quat::Identity(), Vec3(0, y, 0)});
        return d;
    };
    const SimSettings settings;
    Simulation simulation(m, apparatus, settings);
    const std::vector<Drive> way = {drive(0.5), drive(-0.5)};
    simulation.plan_cuts(0, way, 1);
    const Aggregate planned = simulation.planned(0);
    REQUIRE(simulation.keep(0, planned, find_crumbs(find_pieces(planned))));
    const FrameReport r = simulation.advance(way[0], way[1]);
    CHECK(r.severed > 0);
    CHECK(r.pieces == 2);
}

TEST_CASE("a crumb can carry a skin once its particles do not lie in a row") {
    // Of the corner of a block: one particle, four and a layer of six; then a row.
    Aggregate m = make_block(5, 2, 1, 0.1, Material{});
    const Vec3 corner = m.particle_position.at(0);
    const auto look = [&](const Vec3& normal, double reach, std::ptrdiff_t crumbs, bool unturned) {
        CAPTURE(reach);
        Aggregate cut = m;
        cut_along(cut, corner + 0.1 * reach * normal.normalized(), normal, 3, 1);
        const Pieces pieces = find_pieces(cut);
        REQUIRE(pieces.count == 2);
        const auto own = static_cast<std::size_t>(pieces.particle_piece[0]);
        CHECK(particles_in_crumbs(pieces) == crumbs);
        CHECK(find_crumbs(pieces)[own] == 1);
        CHECK(find_crumbs(pieces)[1 - own] == 0);
        CHECK((find_unturned(pieces, cut)[own] == 1) == unturned);
        CHECK(find_unturned(pieces, cut)[1 - own] == 0);
    };
    look(Vec3::Ones(), 0.3, 1, true);
    look(Vec3::Ones(), 0.7, 4, false);
    look(Vec3::UnitX(), 0.5, 6, false);
    look(Vec3(0, 1, 1), 0.3, 6, true);
}

TEST_CASE("crumbs of an earlier stage are not blamed on the first blade of the next") {
    Aggregate m = make_block(6, 2, 2, 0.1, Material{});
    const Vec3 corner = m.particle_position.at(0);
    cut_along(m, corner + Vec3::Constant(0.02), Vec3::Ones(), 3, 1);
    REQUIRE(find_pieces(m).count == 2);  // one is a single particle
    Apparatus apparatus;
    apparatus.name = "cut";
    apparatus.blade.push_back({"blade", {Vec3(0.02, 0, -1), Vec3(0.02, 0, 1)}, {}});
    const auto drive = [](double y) {
        Drive d;
        d.world_from_blade = {Pose{Quat::Identity(), Vec3(0, y, 0)}};
        return d;
    };
    const SimSettings settings;
    Simulation simulation(m, apparatus, settings);
    const FrameReport r = simulation.advance(drive(0.5), drive(-0.5));
    CHECK(r.severed > 0);
    CHECK(r.pieces == 3);
    CHECK(r.warning.empty());
}

TEST_CASE("what contacts held by matter that a blade cuts through stays on the books") {
    const Solver solver =
        GENERATE(Solver::explicit_steps, Solver::energy_stepped, Solver::quasistatic);
    Aggregate block = make_block(4, 4, 4, 0.02, kPad);
    place(block, {Quat::Identity(), Vec3(0, 0.04, 0)});
    Apparatus apparatus = floor_with(0.5);
    // Through the lowest layer, which bears the block.
    apparatus.blade.push_back({"blade", {Vec3(0, 0.01, -1), Vec3(0, 0.01, 1)}, {}});
    SimSettings settings = lying(solver, 0.01);
    settings.tolerance = 1e-3;
    const auto drive = [&](double time, double x) {
        Drive d = cut_at(time, x);
        if (solver == Solver::quasistatic) d.gravity_strength = std::min(1.0, time / 0.2);
        return d;
    };
    Simulation simulation(block, apparatus, settings);
    FrameReport r;
    for (int n = 0; n < 8; ++n) {
        r = simulation.advance(drive(0.05 * n, -1), drive(0.05 * (n + 1), -1));
    }
    const double held = r.contact, open = r.remainder;
    REQUIRE(held > 1e-4);
    r = simulation.advance(drive(0.4, -1), drive(0.401, 1));
    INFO("held " << held << ", remainder " << open << ", then " << r.remainder);
    CHECK(r.severed > 0);
    CHECK(r.severed_energy > 0.5 * held);
    CHECK(std::abs(r.remainder - open) < 0.02 * held);
}

TEST_CASE("what a body held of one that a blade cuts under it stays on the books", "[stress]") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    Material heavy = kPad;
    heavy.density = 20000;
    Aggregate bed = make_block(6, 4, 4, 0.02, kPad), weight = make_block(3, 2, 2, 0.02, heavy);
    place(bed, {Quat::Identity(), Vec3(0, 0.04, 0)});
    place(weight, {Quat::Identity(), Vec3(0, 0.1, 0)});
    Apparatus apparatus = floor_with(0.5);
    apparatus.blade.push_back({"blade", {Vec3(0, 0.07, -1), Vec3(0, 0.07, 1)}, {}});
    Simulation simulation({&bed, &weight}, apparatus, lying(solver, 0.02));
    FrameReport r;
    for (int n = 0; n < 8; ++n) {
        r = simulation.advance(cut_at(0.05 * n, -1), cut_at(0.05 * (n + 1), -1));
    }
    const double held = r.body[1].contact, open = r.remainder;
    REQUIRE(held > 1e-4);
    r = simulation.advance(cut_at(0.4, -1), cut_at(0.401, 1));
    INFO("held " << held << ", remainder " << open << ", then " << r.remainder);
    CHECK(r.severed > 0);
    CHECK(std::abs(r.remainder - open) < 0.02 * held);
}

namespace {

struct FlownCut {
    std::size_t severed = 0, planned = 0;
    int pieces = 0;
    std::vector<std::string> warning;
};

// A blade comes down x = 0 by 2 cm a frame, beside which a body of 2 cm cells flies at this speed.
// The cut is planned where they meet.
FlownCut cut_in_flight(const Vec3& speed, Solver solver) {
    FlyingBlock flying(speed);
    auto& [block, apparatus] = flying;
    std::vector<Drive> way;
    for (int n = 0; n <= 8; ++n) {
        way.push_back(FlyingBlock::with_edge_at(0.07 - 0.02 * n, 0.01 * n));
    }
    Simulation simulation(block, apparatus, motion_settings(solver));
    simulation.plan_cuts(0, way, 1);
    FlownCut flown;
    flown.planned = block.connection_count() - simulation.planned(0).connection_count();
    for (std::size_t n = 0; n + 1 < way.size(); ++n) {
        const FrameReport r = simulation.advance(way[n], way[n + 1]);
        flown.severed += std::size_t(r.severed);
        flown.pieces = r.pieces;
        flown.warning.insert(flown.warning.end(), r.warning.begin(), r.warning.end());
    }
    return flown;
}

}  // namespace

TEST_CASE("what has moved out of the path of a blade is not severed by it, and that is told") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    const FlownCut flown = cut_in_flight(Vec3(2, 0, 0), solver);
    CHECK(flown.severed > 0);
    CHECK(flown.severed < flown.planned / 2);
    CHECK(flown.pieces == 1);
    REQUIRE(flown.warning.size() == 1);
    CHECK(flown.warning[0].find(fmt::format("{} connections that lay in the blade's path",
                                            flown.planned - flown.severed)) == 0);
}

TEST_CASE("what moves along the path of a blade is severed when that has come so far") {
    const Solver solver = GENERATE(Solver::explicit_steps, Solver::energy_stepped);
    // Against the blade, which is through it sooner; away from it, for a while; along its edge.
    const Vec3 speed = GENERATE(Vec3(0, 0, 0), Vec3(0, 3, 0), Vec3(0, -0.5, 0), Vec3(0, 0, 5));
    CAPTURE(speed.transpose());
    const FlownCut flown = cut_in_flight(speed, solver);
    CHECK(flown.severed == flown.planned);
    CHECK(flown.pieces == 2);
    CHECK(flown.warning.empty());
}
