// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/load_set.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("loads put on slowly leave the books of a resting body closed, and at once do not") {
    Aggregate start = make_block(16, 4, 4, 0.025, kSoft);
    Apparatus apparatus;
    apparatus.grip.push_back(
        hold(start, points_where(start, [](const Vec3& x) { return x.x() < -0.199; })));
    apparatus.load.push_back(force_on(
        start, points_where(start, [](const Vec3& x) { return x.x() > 0.199; }), {0.5, 0, -0.3}));
    SimSettings settings;
    settings.tolerance = 1e-4;
    settings.grip_stiffness = 100;
    settings.gravity = {0, 0, -3};
    for (int frames : {8, 1}) {
        Aggregate matter = start;
        const FrameReport r = put_on(matter, apparatus, settings, frames);
        CHECK(r.load_work > 0);
        CHECK(r.gravity_work > 0);
        const double work = r.load_work + r.gravity_work;
        CHECK(r.elastic == Approx(work).epsilon(0.02));
        CHECK(std::abs(r.remainder) < 0.02 * work);
        REQUIRE(r.load.size() == 3);
        CHECK(r.load[1].work == r.load_work);
        CHECK(r.load[2].name == "gravity");
        // What the vice holds is what is asked for.
        CHECK((r.load[0].force + r.load[1].force + r.load[2].force).norm() <
              1e-3 * r.load[2].force.norm());
    }
    Aggregate matter = start;
    Simulation simulation(matter, apparatus, settings);
    const FrameReport r = simulation.advance(drive_of(apparatus, 0, 1), drive_of(apparatus, 1, 1));
    CHECK(r.remainder == Approx(0.5 * (r.load_work + r.gravity_work)).epsilon(0.05));
}

TEST_CASE("a load that is taken off leaves nothing behind, and tools far away change nothing") {
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        Material steel{.young_modulus = 2e11, .poisson_ratio = 0.25, .density = 7800};
        steel.mechanics = mechanics;
        Aggregate matter = make_block(24, 2, 2, 0.01, steel);
        Apparatus apparatus;
        apparatus.name = "hold";
        apparatus.grip = {
            hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.1199; }))};
        apparatus.load = {
            force_on(matter, points_where(matter, [](const Vec3& x) { return x.x() > 0.1199; }),
                     Vec3(0, -5, 0))};
        apparatus.tool.push_back({"far", BoxShape{Vec3(0.1, 0.1, 0.1), 0}, 0.3});
        SimSettings settings;
        Simulation simulation(matter, apparatus, settings);
        const auto at = [&](double time, double strength) {
            Drive d = drive_of(apparatus, time, strength);
            d.world_from_tool.push_back({Quat::Identity(), Vec3(0, 1 - 0.1 * time, 0)});
            return d;
        };
        // The force of the grip, and the elastic energy.
        std::vector<FrameReport> report;
        const double strength[] = {0, 0.5, 1, 0.5, 0, 0};
        for (int n = 1; n < 6; ++n) {
            report.push_back(simulation.advance(at(n - 1, strength[n - 1]), at(n, strength[n])));
        }
        INFO("mechanics " << int(mechanics));
        CHECK(report[1].load.at(1).force.y() == Approx(5).epsilon(0.02));
        for (int n : {3, 4}) {
            CHECK(std::abs(report[n].load.at(1).force.y()) < 0.02 * 5);
            CHECK(report[n].elastic < 1e-3 * report[1].elastic);
        }
    }
}

TEST_CASE("in explicit steps the work of loads and gravity is what moves and strains the body") {
    Material material = kSoft;
    material.damping_ratio = 0;
    Aggregate matter = make_block(8, 3, 3, 0.05, material);
    Apparatus apparatus;
    apparatus.load.push_back(force_on(
        matter, points_where(matter, [](const Vec3& x) { return x.x() > 0.199; }), {20, 0, 5}));
    apparatus.load.push_back(pressure_on(matter, 3e3));
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.step_safety = 0.2;
    settings.gravity = {0, -9.81, 0};
    Simulation simulation(matter, apparatus, settings);
    FrameReport r;
    for (int f = 0; f < 4; ++f) {
        r = simulation.advance(drive_of(apparatus, 0.05 * f, 0.25 * f),
                               drive_of(apparatus, 0.05 * (f + 1), 0.25 * (f + 1)));
    }
    CHECK(r.load_work > 0.05 * r.gravity_work);
    CHECK(r.kinetic + r.elastic == Approx(r.load_work + r.gravity_work).epsilon(0.01));
    CHECK(std::abs(r.remainder) < 0.01 * r.kinetic);
    // Pressure all round does not drive it, so the rest is Newton's.
    Vec3 momentum = Vec3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        momentum += matter.particle_mass[p] * matter.particle_velocity.at(p);
    }
    const Vec3 pushed = 0.1 * (Vec3(20, 0, 5) + matter.mass() * Vec3(0, -9.81, 0));
    CHECK((momentum - pushed).norm() < 0.01 * pushed.norm());
}

TEST_CASE("a grip along one axis holds that one and leaves the others free") {
    Aggregate matter = make_block(6, 4, 4, 0.05, kSoft);
    const auto at = [&](int axis) {
        return points_where(matter, [&](const Vec3& x) {
            return x[axis] < -0.5 * 0.05 * (axis == 0 ? 6 : 4) + 1e-6;
        });
    };
    Apparatus apparatus;
    for (int axis = 0; axis < 3; ++axis) {
        apparatus.grip.push_back(hold(matter, at(axis), Vec3::Unit(axis)));
    }
    const double stress = 1e3;
    const auto end = points_where(matter, [](const Vec3& x) { return x.x() > 0.149; });
    apparatus.load.push_back(force_on(matter, end, {stress * 0.04, 0, 0}));
    SimSettings settings;
    settings.tolerance = 1e-5;
    settings.grip_stiffness = 100;
    put_on(matter, apparatus, settings, 1);
    // Three smooth planes keep nothing from Hooke's strain.
    const double strain = stress / kSoft.young_modulus;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3Array& x = matter.particle_position;
        const ReferencePlaces& from = matter.particle_reference;
        const double expected = axis == 0 ? strain : -kSoft.poisson_ratio * strain;
        double stretched = 0, length = 0;
        for (std::size_t p = 0; p < x.size(); ++p) {
            const double far = from.at(p)[axis];
            if (std::abs(far) < 0.099) continue;
            stretched += far > 0 ? x.at(p)[axis] - far : far - x.at(p)[axis];
            length += std::abs(far);
        }
        CHECK(stretched / length == Approx(expected).epsilon(0.01));
    }
}

TEST_CASE(
    "a piece that nothing holds does not fall for ever: loads leave it alone, and it is told") {
    for (double modulus : {1e6, 1e11}) {
        Material material = kSoft;
        material.young_modulus = modulus;
        Aggregate whole = make_block(6, 3, 3, 0.05, material);
        Aggregate matter = make_block(12, 3, 3, 0.05, material);
        sever_plane(matter, Vec3::Zero(), Vec3::UnitX());
        SimSettings settings;
        settings.gravity = {0, -9.81, 0};
        const auto hang = [&](Aggregate& body, double end) {
            Apparatus apparatus;
            apparatus.grip.push_back(
                hold(body, points_where(body, [&](const Vec3& x) { return x.x() < end + 1e-6; })));
            return put_on(body, apparatus, settings, 1);
        };
        hang(whole, -0.15);
        double alone = 0;
        const FrameReport report = hang(matter, -0.3);
        REQUIRE(report.pieces == 2);
        REQUIRE(report.warning.size() == 1);
        CHECK(report.warning[0].find("a piece would fall") == 0);
        const auto farthest = [](const Aggregate& body, bool right) {
            double most = 0;
            for (std::size_t p = 0; p < body.particle_count(); ++p) {
                const Vec3 from = body.particle_reference.at(p);
                if ((from.x() > 0.01) != right) continue;
                most = std::max(most, (body.particle_position.at(p) - from).norm());
            }
            return most;
        };
        CHECK(farthest(matter, true) < 0.5 * 0.05);
        // It weighs half a layer of cells more than alone.
        for (std::size_t p = 0; p < whole.particle_count(); ++p) {
            alone = std::max(
                alone, (whole.particle_position.at(p) - whole.particle_reference.at(p)).norm());
        }
        CHECK(farthest(matter, false) == Approx(alone).epsilon(0.3));
    }
}

TEST_CASE("what is cut under a grip pulls no more at what it was cut from") {
    for (const Solver solver : {Solver::quasistatic, Solver::explicit_steps}) {
        Aggregate matter = make_block(10, 3, 3, 0.1, kSoft);
        Apparatus apparatus;
        apparatus.name = "draw";
        // The right one reaches up to the cut, half-way through a cell.
        apparatus.grip = end_grips(matter, 0.36);
        SimSettings settings;
        settings.solver = solver;
        const Vec3 cut(0.353, 0, 0);
        Simulation simulation(matter, apparatus, settings);
        const auto at = [&](double time, double way) {
            Drive d = drive_of(apparatus, time, 0);
            d.world_from_grip[1].translation.x() = way;
            return d;
        };
        FrameReport report = simulation.advance(at(0, 0), at(1, 0));
        CHECK(report.pieces == 1);
        sever_plane(matter, cut, Vec3::UnitX());
        Simulation after(matter, apparatus, settings);
        report = after.advance(at(1, 0), at(2, 0.3));
        INFO("solver " << int(solver));
        CHECK(find_pieces(matter).count == 2);
        for (int grip : {0, 1}) CHECK(report.load.at(grip).force.norm() < 1e-3 * 1e6 * 0.09 * 0.1);
        CHECK(report.elastic < 1e-6 * 1e6 * 0.09);
    }
}

TEST_CASE("what is left alone weighs nothing, and no work is done on it when it is lifted") {
    Material material = kSoft;
    material.young_modulus = 5e5;
    Aggregate matter = make_block(12, 3, 3, 0.05, material);
    sever_plane(matter, Vec3(0.026, 0, 0), Vec3::UnitX());
    Apparatus apparatus;
    apparatus.name = "lift";
    apparatus.tool.push_back({"lift", BoxShape{Vec3(0.15, 0.1, 0.3), 0.01}, 0});
    apparatus.grip.push_back(
        hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.2999; })));
    apparatus.load.push_back(force_on(
        matter, points_where(matter, [](const Vec3& x) { return x.x() > 0.2999; }), {0, -1, 0}));
    SimSettings settings;
    settings.tolerance = 1e-4;
    settings.grip_stiffness = 100;
    settings.gravity = {0, -9.81, 0};
    // The tool is out of reach of what falls, comes up to it, and lifts it by two cells.
    const double strength[] = {0, 0.5, 1, 1, 1, 1, 1};
    const double top[] = {-1.1, -1.1, -1.1, -0.1, -0.05, 0, 0.025};
    const auto at = [&](int n) {
        Drive d = drive_of(apparatus, n, strength[n]);
        d.world_from_tool.push_back({Quat::Identity(), Vec3(0.175, top[n] - 0.05, 0)});
        return d;
    };
    Simulation simulation(matter, apparatus, settings);
    std::vector<FrameReport> report;
    for (int n = 1; n <= 6; ++n) report.push_back(simulation.advance(at(n - 1), at(n)));
    REQUIRE(report[0].warning.size() == 1);
    CHECK(report[0].warning[0].find("a piece would fall") == 0);

    double held = 0, lift = 0, lifted = 0;  // masses [kg]; times the way up [kg m]
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 from = matter.particle_reference.at(p);
        const double mass = matter.particle_mass[p];
        (from.x() < 0.026 ? held : lifted) += mass;
        if (from.x() > 0.026) lift += mass * (matter.particle_position.at(p) - from).y();
    }
    CHECK(lift > 0.09 * lifted);
    const FrameReport &hung = report[1], &end = report.back();
    CHECK(hung.gravity_work == Approx(hung.elastic + hung.contact).epsilon(0.05));
    CHECK(end.gravity_work == Approx(hung.gravity_work).epsilon(0.02));
    CHECK(end.load_work == 0);
    CHECK(std::abs(end.remainder) < 0.05 * end.gravity_work);
    REQUIRE(end.load.size() == 4);
    CHECK(end.load[2].force.isZero(0));
    CHECK(end.load[3].force.y() == Approx(-9.81 * held));
    CHECK((end.load[1].force + end.load[3].force).norm() < 0.01 * 9.81 * held);
}

TEST_CASE("what is cut off under a grip is carried along no more, and would fall") {
    for (const double gravity : {0.0, 9.81}) {
        Aggregate matter = make_block(10, 3, 3, 0.1, kSoft);
        Apparatus apparatus;
        apparatus.name = "draw";
        // It reaches up to the cut, half-way through a cell.
        apparatus.grip.push_back(end_grips(matter, 0.36)[1]);
        sever_plane(matter, Vec3(0.353, 0, 0), Vec3::UnitX());
        SimSettings settings;
        settings.gravity = {0, -gravity, 0};
        Drive drawn = drive_of(apparatus, 1, 1);
        drawn.world_from_grip[0].translation.x() = 0.3;
        const FrameReport report =
            Simulation(matter, apparatus, settings).advance(drive_of(apparatus, 0, 0), drawn);
        INFO("gravity " << gravity);
        CHECK(report.pieces == 2);
        REQUIRE(report.warning.size() == (gravity > 0));
        if (gravity > 0) CHECK(report.warning[0].find("a piece would fall") == 0);
        double farthest = 0;  // from where each piece should be
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            const Vec3 from = matter.particle_reference.at(p);
            const Vec3 there = from + Vec3(from.x() > 0.353 ? 0.3 : 0, 0, 0);
            farthest = std::max(farthest, (matter.particle_position.at(p) - there).norm());
        }
        CHECK(farthest < 0.5 * 0.1);
    }
}

TEST_CASE("what hangs by a hinge alone is left alone by loads, and told") {
    // A bar cut through but for the particles of one edge, or of its lowest layer of cells.
    for (int left : {0, 1}) {
        Material material = kSoft;
        material.young_modulus = 1e11;
        Aggregate matter = make_block(13, 4, 4, 0.05, material);
        sever_plane(matter, Vec3::Zero(), Vec3::UnitX(),
                    [&](const Vec3& at) { return at.y() > -0.1 + 0.05 * left + 1e-6; });
        Apparatus apparatus;
        apparatus.grip.push_back(
            hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.324; })));
        const auto end = points_where(matter, [](const Vec3& x) { return x.x() > 0.324; });
        apparatus.load.push_back(force_on(matter, end, {0, -100, 0}));
        const FrameReport report = put_on(matter, apparatus, {}, 1);
        CHECK(report.pieces == 1);
        REQUIRE(report.warning.size() == (left == 0));
        double farthest = 0;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            farthest =
                std::max(farthest,
                         (matter.particle_position.at(p) - matter.particle_reference.at(p)).norm());
        }
        CHECK(farthest < 0.01 * 0.05);
        if (left == 1) {
            CHECK(farthest > 1e-7 * 0.05);
            continue;
        }
        CHECK(report.warning[0].find("a piece hangs by less than a whole cell") == 0);
    }
}

TEST_CASE("a body that nothing holds falls, and that is said") {
    Aggregate matter = make_block(4, 3, 3, 0.05, kSoft);
    SimSettings settings;
    settings.gravity = {0, -9.81, 0};
    Aggregate broken = matter;
    broken.connection[0].damage.assign(broken.particle_count(), 0);
    broken.connection[0].damage[0] = 1;
    broken.connection[0].weight.set(0, 0);
    const std::string told = stopped_by(matter, Apparatus{}, settings, 1);
    CHECK(told.find("the work-piece falls") != std::string::npos);
    const std::string of_broken = stopped_by(broken, Apparatus{}, settings, 1);
    CHECK(of_broken.find("the work-piece, which has broken, falls") != std::string::npos);
}

TEST_CASE("beyond a limit load there is no rest, and the message says what to do") {
    Material material = kSoft;
    material.yield_stress = 1e3;
    SimSettings settings;
    settings.iteration_limit = 500;
    settings.halving_limit = 1;
    // A hinge forms at yield_stress b h^2 / 4 over the arm: 0.6 N.
    for (double force : {0.5, 3.0}) {
        Aggregate matter = make_block(8, 2, 2, 0.05, material);
        Apparatus apparatus;
        apparatus.grip.push_back(
            hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.199; })));
        const auto end = points_where(matter, [](const Vec3& x) { return x.x() > 0.199; });
        apparatus.load.push_back(force_on(matter, end, {0, -force, 0}));
        const std::string told = stopped_by(matter, apparatus, settings, 10);
        INFO(told);
        CHECK((told.find("loads that it cannot bear") != std::string::npos) == (force > 0.6));
        CHECK(told.empty() == (force < 0.6));
        if (force < 0.6) continue;
        // In steps of 0.15 N, and a hinge in two cells bears a little more.
        const std::size_t under = told.find("last at rest at ");
        REQUIRE(under != std::string::npos);
        CHECK((told.find("s under 600 mN of push;", under) != std::string::npos ||
               told.find("s under 750 mN of push;", under) != std::string::npos));
    }
}

TEST_CASE("a bar bears loads however small, and says where they are less than rounding leaves") {
    const double a = 0.01;
    const Material steel{.young_modulus = 2e11, .poisson_ratio = 0.3};
    const auto sag = [&](double load, std::vector<std::string>& warning) {
        Aggregate bar = make_block(12, 2, 2, a, steel);
        Apparatus apparatus;
        apparatus.grip.push_back(
            hold(bar, points_where(bar, [&](const Vec3& x) { return x.x() < -5.9 * a; })));
        apparatus.load.push_back(
            force_on(bar, points_where(bar, [&](const Vec3& x) { return x.x() > 5.9 * a; }),
                     Vec3(0, -load, 0)));
        warning = put_on(bar, apparatus, SimSettings{}, 1).warning;
        return -bar.particle_position.y.back() +
               bar.particle_reference.at(bar.particle_count() - 1).y();
    };
    std::vector<std::string> warning;
    const double of_a_newton = sag(1, warning);
    CHECK(warning.empty());
    CHECK(of_a_newton > 0);
    for (const double load : {1e-3, 1e-5, 1e-7}) {
        CAPTURE(load);
        const double small = sag(load, warning);
        REQUIRE(warning.size() == 1);
        CHECK(warning[0].find("loads are so small") != std::string::npos);
        CHECK(std::abs(small - load * of_a_newton) < 1e-3 * of_a_newton);
    }
}

// A hundredth of this load is beyond what numbers hold of places.
TEST_CASE("what is let go of rests as exactly as it can, and says where loads ask for more") {
    for (const double pulled : {1.1, 1 + 1e-7}) {
        Material material = kSoft;
        material.mechanics = Mechanics::springs;
        Aggregate block = make_block(6, 2, 2, 0.05, material);
        for (double& x : block.particle_position.x) x *= pulled;
        Apparatus apparatus;
        apparatus.grip.push_back(
            hold(block, points_where(block, [](const Vec3& x) { return x.x() < -0.14; })));
        apparatus.load.push_back(
            force_on(block, points_where(block, [](const Vec3& x) { return x.x() > 0.14; }),
                     Vec3(0, -1e-13, 0)));
        const FrameReport report = put_on(block, apparatus, SimSettings{}, 1);
        REQUIRE(report.warning.size() == 1);
        CHECK(report.warning[0].find("loads are so small") != std::string::npos);
        const auto& x = block.particle_position.x;
        const auto [low, high] = std::minmax_element(x.begin(), x.end());
        CHECK(*high - *low == Approx(0.3).epsilon(1e-6));
    }
}

TEST_CASE("what patches leave over of loads takes nothing away where grips leave it free") {
    for (const bool guided : {true, false}) {
        Aggregate matter = make_block(8, 4, 4, 0.025, kSoft);
        Apparatus apparatus;
        for (const double side : {-1.0, 1.0}) {
            const auto end =
                points_where(matter, [&](const Vec3& x) { return side * x.x() > 0.0999; });
            if (guided) apparatus.grip.push_back(hold(matter, end, Vec3::UnitX()));
        }
        Load load;
        load.name = "pressure";
        load.pressure = 1e4;
        load.point = points_where(matter, [](const Vec3& x) { return std::abs(x.y()) > 0.0499; });
        load.point.pop_back();  // 1 of 256 on one side presses less
        apparatus.load.push_back(load);
        const Vec3 from = matter.centre();
        CHECK(put_on(matter, apparatus, {}, 4).elastic > 0);
        CHECK((matter.centre() - from).norm() < 0.05 * matter.lattice.spacing);
    }
}

TEST_CASE("where gravity or a load acts at once and there is no rest, the message says so") {
    // A strip held at one end, which sags by far more than it is thick.
    SimSettings settings;
    settings.iteration_limit = 100;
    settings.halving_limit = 0;
    Material material = kSoft;
    material.young_modulus = 1e3;
    Aggregate matter = make_block(16, 1, 2, 0.05, material);
    Apparatus apparatus;
    apparatus.grip.push_back(
        hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.399; })));
    const auto end = points_where(matter, [](const Vec3& x) { return x.x() > 0.399; });
    apparatus.load.push_back(force_on(matter, end, {0, -20, 0}));
    struct Case {
        double gravity, weight_at_start, load_at_start, load_at_end;
    };
    for (const auto& [gravity, weight, load, load_at_end] : {Case{9.81, 1, 0, 0},
                                                             {9.81, 0, 0, 0},
                                                             {0, 1, 1, 1},
                                                             {0, 1, 0, 1},
                                                             {9.81, 1, 1, 1},
                                                             {9.81, 0, 1, 1}}) {
        CAPTURE(gravity, weight, load, load_at_end);
        settings.gravity = {0, -gravity, 0};
        Aggregate strip = matter;
        Simulation simulation(strip, apparatus, settings);
        Drive from = still(0), to = still(1);
        from.world_from_grip.emplace_back(), to.world_from_grip.emplace_back();
        from.gravity_strength = weight;
        from.load_strength = {load}, to.load_strength = {load_at_end};
        std::string told;
        try {
            simulation.advance(from, to);
        } catch (const Error& error) {
            told = error.what();
        }
        INFO(told);
        REQUIRE(told.find("no equilibrium found") != std::string::npos);
        const auto says = [&](const char* words) { return told.find(words) != std::string::npos; };
        const bool by_weight = gravity > 0 && weight > 0, by_load = load > 0;
        CHECK(says("from the first instant on") == (by_weight || by_load));
        CHECK(says("gravity_strength = \"t\"") == by_weight);
        CHECK((says(" strength = \"t\"")) == by_load);
        CHECK(says("gravity and push act ") == (by_weight && by_load));
        CHECK(says("last at rest at 0 s") == !(by_weight || by_load));
    }
}
