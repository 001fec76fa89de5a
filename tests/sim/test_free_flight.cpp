// SPDX-License-Identifier: GPL-3.0-or-later
// What flies by itself goes in one step as far as nothing can touch it, and as short steps have it.
#include "sim/advance.h"
#include "sim/free_flight.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Vec3 kGravity(0, -9.81, 0);
const Material kStiff{.young_modulus = 1e8, .density = 1000, .damping_ratio = 0};

struct Scene {
    Apparatus apparatus;
    std::vector<Pose> from, to;               // of each tool, where a leg begins and where it ends
    std::vector<std::optional<WayEnds>> way;  // how it gets there, where not evenly
    double gravity_at_start = 1;              // of what acts at the leg's end
    std::vector<Aggregate> body;
    SimSettings settings = motion_settings();

    Scene() {
        apparatus.name = "drop";
        settings.gravity = kGravity;
    }
    void add_tool(const Shape& shape, const Pose& from_pose, const Pose& to_pose) {
        apparatus.tool.push_back({"tool", shape, 0.3});
        from.push_back(from_pose);
        to.push_back(to_pose);
    }
    void add_floor() {  // its upper side at y = 0
        const Pose stands{Quat::Identity(), Vec3(0, -1, 0)};
        add_tool(BoxShape{Vec3(50, 2, 50), 0}, stands, stands);
    }
    Aggregate& add_block(const Pose& pose, const Vec3& velocity,
                         const Material& material = kStiff) {
        body.push_back(make_block(3, 2, 4, 0.1, material));
        place(body.back(), pose);
        for (std::size_t p = 0; p < body.back().particle_count(); ++p) {
            body.back().particle_velocity.set(p, velocity);
        }
        return body.back();
    }
    Drive drive(double time, const std::vector<Pose>& tool) const {
        Drive d = still(time);
        d.world_from_tool = tool;
        return d;
    }
    // One leg of this time. `steps`: it takes as short ones as ever, for a load that does nothing
    // could come to do something.
    FrameReport go(double time, bool steps = false) {
        if (steps) {
            Load& idle = apparatus.load.emplace_back();
            idle.name = "idle";
            idle.point = {0};
            idle.force = {Vec3::Zero()};
        }
        std::vector<Aggregate*> bodies;
        for (Aggregate& m : body) bodies.push_back(&m);
        Simulation simulation(bodies, apparatus, settings);
        Drive begin = drive(0, from), end = drive(time, to);
        begin.gravity_strength = gravity_at_start;
        end.tool_way = way;
        begin.load_strength = end.load_strength =
            std::vector<double>(apparatus.load.size(), steps ? 1.0 : 0.0);
        return simulation.advance(begin, end);
    }
};

double farthest_apart(const Vec3Array& a, const Vec3Array& b) {
    double most = 0;
    for (std::size_t p = 0; p < a.size(); ++p) most = std::max(most, (a.at(p) - b.at(p)).norm());
    return most;
}

// Steps strike at other times in the two, so that they differ by what a step makes of a blow: in
// steps of this share of the longest.
void check_same(const Scene& one, const Scene& other, double share) {
    for (std::size_t b = 0; b < one.body.size(); ++b) {
        CHECK(farthest_apart(one.body[b].particle_position, other.body[b].particle_position) <
              0.01 * share);
    }
}

const Pose kAslant{turn_by(Vec3(0.4, 0.2, -0.3)), Vec3(0.1, 5, -0.2)};

}  // namespace

TEST_CASE("what falls past nothing takes one step, to where gravity has it") {
    Scene scene;
    scene.add_floor();
    const Vec3 v(0.7, 1.2, -0.4);
    const Aggregate before = scene.add_block(kAslant, v);
    const double t = 0.5;
    const FrameReport report = scene.go(t);
    CHECK(report.steps == 1);
    const Aggregate& m = scene.body[0];
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 at = before.particle_position.at(p) + t * v + 0.5 * t * t * kGravity;
        CHECK((m.particle_position.at(p) - at).norm() < 1e-13);
        CHECK((m.particle_velocity.at(p) - (v + t * kGravity)).norm() < 1e-14);
    }
    const double work = m.mass() * kGravity.dot(t * v + 0.5 * t * t * kGravity);
    CHECK(report.gravity_work == Approx(work).epsilon(1e-12));
    CHECK(report.kinetic - report.kinetic_at_start == Approx(work).epsilon(1e-12));
    CHECK(std::abs(report.remainder) < 1e-12 * std::abs(work));
}

TEST_CASE("what flies strikes and rebounds as it does in steps all the way") {
    for (double share : {0.2, 0.05}) {
        for (double tilt : {0.0, 0.5}) {
            CAPTURE(share, tilt);
            const auto make = [&] {
                Scene scene;
                scene.settings.step_safety = share;
                scene.add_floor();
                const Pose pose{turn_by(Vec3(tilt, 0, 0.7 * tilt)), Vec3(0, 1.5, 0)};
                scene.add_block(pose, Vec3(2, 0, 0.5));
                return scene;
            };
            Scene flies = make(), steps = make();
            const FrameReport flown = flies.go(0.6), stepped = steps.go(0.6, true);
            CHECK(flown.damped > 1);  // it has struck
            CHECK(flown.steps < 0.25 * double(stepped.steps));
            check_same(flies, steps, share);
            CHECK(flown.kinetic == Approx(stepped.kinetic).epsilon(0.05 * share));
            CHECK(std::abs(flown.remainder) < 0.2 * share * flown.kinetic_at_start);
        }
    }
}

TEST_CASE("bodies that fly at each other meet as they do in steps all the way") {
    for (double share : {0.2, 0.05}) {
        CAPTURE(share);
        const auto make = [&] {
            Scene scene;
            scene.settings.step_safety = share;
            scene.settings.gravity = Vec3(0, -1, 0);
            scene.add_block({Quat::Identity(), Vec3(-2, 0, 0)}, Vec3(3, 0, 0));
            scene.add_block({Quat::Identity(), Vec3(2, 0.03, 0.05)}, Vec3(-4, 0, 0));
            return scene;
        };
        Scene flies = make(), steps = make();
        const FrameReport flown = flies.go(0.6), stepped = steps.go(0.6, true);
        CHECK(flies.body[0].particle_velocity.at(0).x() < 0);
        CHECK(flown.steps < 0.25 * double(stepped.steps));
        check_same(flies, steps, share);
    }
}

TEST_CASE("short legs take a step each, however long the flight is") {
    Scene scene;
    scene.add_floor();
    scene.add_block(kAslant, Vec3::Zero());
    Simulation simulation(scene.body[0], scene.apparatus, scene.settings);
    long steps = 0;
    for (int n = 0; n < 100; ++n) {
        steps +=
            simulation
                .advance(scene.drive(2e-3 * n, scene.from), scene.drive(2e-3 * (n + 1), scene.from))
                .steps;
    }
    CHECK(steps == 100);
    CHECK(scene.body[0].particle_velocity.at(3).y() == Approx(-9.81 * 0.2).epsilon(1e-12));
}

TEST_CASE("bodies that are dropped together do not keep each other from flying") {
    Scene scene;
    scene.add_floor();
    scene.add_block({Quat::Identity(), Vec3(0, 5, 0)}, Vec3::Zero());
    scene.add_block({Quat::Identity(), Vec3(0.2, 5.21, 0)}, Vec3::Zero());
    CHECK(scene.go(0.8).steps == 1);
}

TEST_CASE(
    "bodies that press on each other as they fall do not fly, nor does what presses on itself") {
    for (const bool one : {false, true}) {
        CAPTURE(one);
        const double depth = 0.002;
        const auto make = [&] {
            Scene scene;
            const Material soft{.young_modulus = 1e5, .density = 1000, .damping_ratio = 0};
            if (one) {  // in two parts, far from each other where it was molded
                scene.settings.self_contact = true;
                const auto block = [](const Vec3& x, double low) {
                    return (Vec3(x.x(), x.y() - low - 0.15, x.z()).cwiseAbs() -
                            Vec3::Constant(0.15))
                        .maxCoeff();
                };
                scene.body.push_back(
                    make_shape([&](const Vec3& x) { return std::min(block(x, 0), block(x, 1)); },
                               Vec3(-0.15, 0, -0.15), Vec3i(3, 13, 3), 0.1));
                Aggregate& m = scene.body[0];
                m.material = soft;
                for (std::size_t p = 0; p < m.particle_count(); ++p) {
                    if (m.particle_reference.at(p).y() > 0.8) {
                        m.particle_position.add(p, Vec3(0, -0.7 - depth, 0));
                    }
                }
            } else {
                scene.add_block({}, Vec3::Zero(), soft);
                scene.add_block({Quat::Identity(), Vec3(0, 0.2 - depth, 0)}, Vec3::Zero(), soft);
            }
            return scene;
        };
        Scene flies = make(), steps = make();
        const FrameReport flown = flies.go(0.3), stepped = steps.go(0.3, true);
        CHECK(stepped.contact_at_start > 0.01);
        CHECK(stepped.contact < 1e-6 * stepped.contact_at_start);  // they have parted
        CHECK(flown.steps == stepped.steps);
        CHECK(flown.contact < 1e-6 * flown.contact_at_start);
        check_same(flies, steps, 1e-8);
    }
}

TEST_CASE("what sticks to another body, or to a tool, is drawn to it and does not fly") {
    for (const bool to_tool : {false, true}) {
        CAPTURE(to_tool);
        Scene scene;
        scene.settings.gravity = Vec3::Zero();
        Material sticky{.young_modulus = 1e5, .density = 1000, .damping_ratio = 0};
        sticky.stickiness = 1e3;
        const double depth = 1e-4, gap = 1e-3;
        if (to_tool) {
            scene.add_floor();
        } else {
            scene.add_block({Quat::Identity(), Vec3(0, -0.1, 0)}, Vec3::Zero(), sticky);
        }
        const double low = 0.1;
        scene.add_block({Quat::Identity(), Vec3(0, low - depth, 0)}, Vec3::Zero(), sticky);
        std::vector<Aggregate*> bodies;
        for (Aggregate& m : scene.body) bodies.push_back(&m);
        Simulation simulation(bodies, scene.apparatus, scene.settings);
        simulation.advance(scene.drive(0, scene.from), scene.drive(1e-4, scene.from));
        // Apart again, unstrained and at rest, as far as what sticks still holds.
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const bool is_upper = b + 1 == bodies.size();
            place(*bodies[b], {Quat::Identity(), Vec3(0, is_upper ? low + gap : -0.1, 0)});
            for (double* v :
                 {bodies[b]->particle_velocity.x.data(), bodies[b]->particle_velocity.y.data(),
                  bodies[b]->particle_velocity.z.data()}) {
                std::fill_n(v, bodies[b]->particle_count(), 0.0);
            }
        }
        const FrameReport r =
            simulation.advance(scene.drive(1e-4, scene.from), scene.drive(0.02, scene.from));
        CHECK(r.steps > 1);
        CHECK(bodies.back()->centre().y() < low + 0.9 * gap);
    }
}

TEST_CASE("what flies meets a tool that comes to it, straight or turning") {
    for (bool turns : {false, true}) {
        CAPTURE(turns);
        const double share = 0.05;
        const auto make = [&] {
            Scene scene;
            scene.settings.step_safety = share;
            const Pose low{Quat::Identity(), Vec3(0, -4, 0)};
            const Pose high = turns ? Pose{turn_by(Vec3(0, 0, 1.5)), Vec3(0, -4, 0)}
                                    : Pose{Quat::Identity(), Vec3(0, -0.5, 0)};
            // A paddle that swings up from the side, or a plate that rises.
            scene.add_tool(BoxShape{turns ? Vec3(8, 0.4, 8) : Vec3(6, 0.4, 6), 0.05}, low, high);
            scene.add_block({Quat::Identity(), Vec3(turns ? 1.5 : 0, 0, 0)}, Vec3::Zero());
            return scene;
        };
        Scene flies = make(), steps = make();
        const FrameReport flown = flies.go(0.5), stepped = steps.go(0.5, true);
        CHECK(flown.work > 0.1);  // it was struck
        CHECK(flown.steps < 0.8 * double(stepped.steps));
        CHECK(flown.kinetic == Approx(stepped.kinetic).epsilon(0.01));
        check_same(flies, steps, share);
    }
}

TEST_CASE(
    "what flies is struck by a tool that turns about the world's origin, or swings up and back") {
    const Pose low{Quat::Identity(), Vec3(0, -3, 0)};
    const Twist up{Vec3::Zero(), Vec3(0, 12, 0)};
    for (const bool turns : {false, true}) {
        CAPTURE(turns);
        const auto struck = [&](bool steps) {
            Scene scene;
            scene.settings.step_safety = 0.2;
            if (turns) {
                scene.add_tool(BoxShape{Vec3(8, 0.4, 8), 0.05}, {},
                               {turn_by(Vec3(0, 0, 1.5)), Vec3::Zero()});
            } else {  // up to where the block is, and down again
                scene.add_tool(BoxShape{Vec3(6, 0.4, 6), 0.05}, low, low);
                scene.way = {WayEnds{up, -1.0 * up}};
            }
            scene.add_block({Quat::Identity(), turns ? Vec3(3, 1.5, 0) : Vec3(0, 0, 0)},
                            Vec3::Zero());
            return scene.go(0.5, steps);
        };
        const FrameReport flown = struck(false), stepped = struck(true);
        CHECK(stepped.work > 1);
        CHECK(flown.work == Approx(stepped.work).epsilon(0.02));
        CHECK(flown.kinetic == Approx(stepped.kinetic).epsilon(0.02));
    }
}

TEST_CASE("what flies falls by gravity as it changes") {
    Scene scene;
    scene.gravity_at_start = 0;
    const double t = 0.5, start = scene.add_block({}, Vec3::Zero()).centre().y();
    const FrameReport r = scene.go(t);
    CHECK(start - scene.body[0].centre().y() == Approx(9.81 * t * t / 6).epsilon(1e-3));
    CHECK(std::abs(r.remainder) < 1e-3 * r.gravity_work);
}

TEST_CASE("what swings or turns slowly does so in flight, however short its steps") {
    // A slender bar, bent by a millionth of what bars bear, let go in the air.
    for (const double share : {0.8, 0.01}) {
        CAPTURE(share);
        Scene scene;
        scene.settings.step_safety = share;
        Aggregate& m = scene.body.emplace_back(make_block(24, 1, 1, 0.1, kStiff));
        const auto bent = [](const Vec3& at) { return 1e-6 * at.x() * at.x(); };
        deform(m, [&](const Vec3& at) { return Vec3(at + bent(at) * Vec3::UnitY()); });
        const double first_bending = 22.373 / (2.4 * 2.4) * std::sqrt(1e8 / 1000.0 * 0.01 / 12);
        scene.settings.gravity = Vec3::Zero();
        const auto sag = [&] {
            const Vec3Array& x = m.particle_position;
            double ends = 0, middle = 0;
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                const double at = m.particle_reference.at(p).x();
                const double y = x.at(p).y() - m.particle_reference.at(p).y();
                if (std::abs(at) > 1.19) ends += y / 8;
                if (std::abs(at) < 0.01) middle += y / 4;
            }
            return ends - middle;
        };
        const double before = sag();
        scene.go(std::numbers::pi / first_bending);  // half a period
        CHECK(sag() < -0.7 * before);
    }
    // A ball's worth of matter that turns by a tenth of a radian in an hour.
    Scene scene;
    scene.settings.gravity = Vec3::Zero();
    Aggregate& m = scene.add_block({}, Vec3::Zero());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(0, 0, 0.1 / 3600).cross(m.particle_position.at(p)));
    }
    CHECK(!flight_velocity(m, 1e-3));
}

TEST_CASE("what is strained, spins or is braked takes its steps") {
    const double step = 1e-3;
    Scene scene;
    Aggregate& m = scene.add_block({}, Vec3(1, 2, 3));
    REQUIRE(flight_velocity(m, step));
    CHECK((*flight_velocity(m, step) - Vec3(1, 2, 3)).norm() < 1e-15);
    m.particle_velocity.add(7, Vec3(1e-9 * m.lattice.spacing / step, 0, 0));
    CHECK(!flight_velocity(m, step));
    CHECK(!holds_strain(m, 0, step));
    CHECK(holds_strain(m, 1e-24 * kStiff.young_modulus * m.volume(), step));

    const auto takes_steps = [](const auto& change) {
        Scene one;
        one.add_block({}, Vec3(0, 1, 0));
        change(one);
        return one.go(0.2).steps > 8;
    };
    CHECK(!takes_steps([](Scene&) {}));
    for (const Elasticity other : {Elasticity::neo_hookean, Elasticity::storakers}) {
        // What rounding leaves of their strain, far from where they were molded, does not hold
        // them.
        CHECK(!takes_steps([&](Scene& one) {
            one.body[0].material.elasticity = other;
            place(one.body[0], kAslant);
        }));
    }
    CHECK(takes_steps([](Scene& one) { one.body[0].particle_position.add(0, Vec3(1e-5, 0, 0)); }));
    CHECK(takes_steps([](Scene& one) { one.settings.medium_density = 1; }));
    CHECK(takes_steps([](Scene& one) {
        Aggregate& block = one.body[0];
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            const Vec3 arm = block.particle_position.at(p) - block.centre();
            block.particle_velocity.add(p, Vec3(0, 0, 0.5).cross(arm));
        }
    }));
    CHECK(takes_steps([](Scene& one) {
        one.body[0].material.damping_ratio = 0.1;
        one.settings.solver = Solver::euler;
    }));
}

TEST_CASE("only gravity acts where nothing holds, cuts, pushes or drags, in explicit steps") {
    SimSettings settings;
    Apparatus apparatus;
    CHECK(!only_gravity_acts(apparatus, settings));  // at rest
    settings.solver = Solver::explicit_steps;
    CHECK(only_gravity_acts(apparatus, settings));
    settings.medium_density = 1.2;
    CHECK(!only_gravity_acts(apparatus, settings));
    settings.drag_coefficient = 0;
    CHECK(only_gravity_acts(apparatus, settings));
    settings.directional_drag = 1;
    CHECK(!only_gravity_acts(apparatus, settings));
    settings.directional_drag = 0;
    apparatus.load.resize(1);
    CHECK(!only_gravity_acts(apparatus, settings));
}
