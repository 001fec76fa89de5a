// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, and blocks that meet, in explicit steps: restitution, static and kinetic friction,
// stickiness, and their books.
#include <Eigen/Eigenvalues>

#include "base/parallel.h"
#include "sim/moving_body.h"
#include "sim/surface_forces.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kG = 9.81;

// A block on a wide floor whose upper side is at y = 0.
struct OnFloor {
    Aggregate block;
    Apparatus apparatus;
    SimSettings settings;
    double rise = 0;  // [s] over which gravity and loads set in

    OnFloor(Aggregate matter, double friction, Solver solver = Solver::explicit_steps)
        : block(std::move(matter)), settings(motion_settings(solver)) {
        apparatus.name = "floor";
        apparatus.tool.push_back({"floor", BoxShape{Vec3(50, 2, 50), 0}, friction});
        settings.gravity = Vec3(0, -kG, 0);
    }
    void lift(double by) {
        for (double& y : block.particle_position.y) y += by;
    }
    void throw_at(const Vec3& v) {
        for (std::size_t p = 0; p < block.particle_count(); ++p) block.particle_velocity.set(p, v);
    }
    Drive drive(double time) const {
        Drive d = still(time);
        d.world_from_tool.push_back({Quat::Identity(), Vec3(0, -1, 0)});
        d.gravity_strength = rise > 0 ? std::min(1.0, time / rise) : 1.0;
        d.load_strength.assign(apparatus.load.size(), 1.0);
        return d;
    }
};

}  // namespace

TEST_CASE("a block comes back from a floor with the asked share of its speed") {
    for (const auto& [solver, e] :
         {std::pair(Solver::explicit_steps, 0.2), std::pair(Solver::explicit_steps, 0.5),
          std::pair(Solver::explicit_steps, 0.8), std::pair(Solver::explicit_steps, 1.0),
          std::pair(Solver::euler, 0.5), std::pair(Solver::energy_stepped, 0.5)}) {
        Material material = kSpringy;
        material.restitution = e;
        material.damping_ratio = solver == Solver::euler ? 0.05 : 0;
        OnFloor floor(make_block(3, 3, 3, 0.1, material), 0, solver);
        floor.settings.gravity.setZero();
        floor.settings.contact_stiffness = 0.01;  // gives way more than the block
        floor.lift(0.151);
        floor.throw_at(Vec3(0, -1, 0));
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        const FrameReport r = simulation.advance(floor.drive(0), floor.drive(0.6));
        const double energy = 0.5 * floor.block.mass();
        INFO(name_of(solver) << ", restitution " << e << ": " << floor.block.mean_velocity().y());
        const bool is_explicit = solver == Solver::explicit_steps;
        CHECK(floor.block.mean_velocity().y() == Approx(e).epsilon(is_explicit ? 0.03 : 0.06));
        CHECK(r.damped / energy == Approx(1 - e * e).margin(is_explicit ? 0.02 : 0.04));
        CHECK(r.contact == 0);
        if (is_explicit) CHECK(std::abs(r.remainder) < 1e-3 * energy);
    }
}

TEST_CASE("the books of a block thrown onto a floor close with the step") {
    for (const double stiffness : {0.1, 2.0}) {
        double before = 0;
        for (const double safety : {0.8, 0.2}) {
            Material material = kSpringy;
            material.restitution = 0.5;
            material.friction = 0.3;
            material.static_friction = 0.4;
            OnFloor floor(make_block(4, 3, 3, 0.1, material), 0.3);
            floor.settings.step_safety = safety;
            floor.settings.contact_stiffness = stiffness;
            floor.lift(0.3);
            floor.throw_at(Vec3(2, -1, 0));
            Simulation simulation(floor.block, floor.apparatus, floor.settings);
            const double energy = floor.block.mass() * (0.5 * 5 + kG * 0.15);
            double most = 0;
            FrameReport r;
            for (int f = 0; f < 60; ++f) {
                r = simulation.advance(floor.drive(0.02 * f), floor.drive(0.02 * (f + 1)));
                most = std::max(most, std::abs(r.remainder) / energy);
            }
            INFO("contact stiffness " << stiffness << ", safety " << safety << ": " << most);
            CHECK(most < 0.01);
            if (before > 0) CHECK(most < 0.5 * before);
            before = most;
            // None of it is where it does not belong.
            CHECK(r.friction > 0.2 * energy);
            CHECK(r.damped > 0.1 * energy);
            CHECK(r.work == 0);
        }
    }
}

TEST_CASE("a block on a floor holds up to static friction and slides at the kinetic one") {
    constexpr double kKinetic = 0.3, kStatic = 0.45;
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    material.friction = kKinetic;
    material.static_friction = kStatic;
    // Pushed along, then on a slope, which is a level where gravity leans.
    for (const bool leans : {false, true}) {
        for (const double share : {0.98, 1.02}) {
            const double ratio = share * kStatic;
            OnFloor floor(make_block(4, 2, 4, 0.1, material), kKinetic);
            floor.lift(0.1);
            double along = ratio * kG, down = kG;
            if (leans) {
                down = kG / std::hypot(1, ratio);
                along = ratio * down;
                floor.settings.gravity = Vec3(0, -down, 0);
            }
            Load push;
            push.name = "push";
            if (leans) {
                for (int p = 0; p < static_cast<int>(floor.block.surface.size()); ++p) {
                    push.point.push_back(p);
                }
            } else {
                push.point =
                    points_where(floor.block, [](const Vec3& x) { return x.y() < -0.0999; });
            }
            const Vec3 each(along * floor.block.mass() / double(push.point.size()), 0, 0);
            push.force.assign(push.point.size(), each);
            floor.apparatus.load.push_back(push);
            const auto drive = [&](double time) {
                Drive d = floor.drive(time);
                d.gravity_strength = std::min(1.0, time / 0.3);
                d.load_strength = {std::clamp((time - 0.4) / 0.3, 0.0, 1.0)};
                return d;
            };
            Simulation simulation(floor.block, floor.apparatus, floor.settings);
            simulation.advance(drive(0), drive(0.3));
            simulation.advance(drive(0.3), drive(0.4));
            const double rest = floor.block.centre().x();
            simulation.advance(drive(0.4), drive(0.7));
            simulation.advance(drive(0.7), drive(1.0));
            const double v = floor.block.mean_velocity().x();
            const FrameReport r = simulation.advance(drive(1.0), drive(1.2));
            const double gained = (floor.block.mean_velocity().x() - v) / 0.2;
            INFO("leans " << leans << ", " << share << " of static friction: gone "
                          << floor.block.centre().x() - rest << ", acceleration " << gained);
            if (share > 1) {
                CHECK(gained == Approx(along - kKinetic * down).epsilon(0.01));
            } else {
                CHECK(std::abs(floor.block.centre().x() - rest) < 5e-4);
                CHECK(std::abs(floor.block.mean_velocity().x()) < 1e-3);
            }
            CHECK(r.load[0].contacts > 0);
        }
    }
}

TEST_CASE("a tool's own friction stands for the material's, static friction in its proportion") {
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    material.friction = 0.3;
    material.static_friction = 0.45;
    // Smooth; 0.2 and 0.3.
    for (const auto& [friction, pull, slides] :
         {std::array{0.0, 0.01, 1.0}, std::array{0.2, 0.28, 0.0}, std::array{0.2, 0.32, 1.0}}) {
        OnFloor floor(make_block(4, 2, 4, 0.1, material), friction);
        floor.lift(0.1);
        floor.rise = 0.3;
        const double g = kG * pull;
        floor.apparatus.load.push_back(push_below(floor.block, g * floor.block.mass()));
        const auto drive = [&](double time) {
            Drive d = floor.drive(time);
            d.load_strength = {std::clamp((time - 0.4) / 0.3, 0.0, 1.0)};
            return d;
        };
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        simulation.advance(drive(0), drive(0.3));
        simulation.advance(drive(0.3), drive(0.4));
        simulation.advance(drive(0.4), drive(0.7));
        simulation.advance(drive(0.7), drive(1.0));
        const double v = floor.block.mean_velocity().x();
        simulation.advance(drive(1.0), drive(1.2));
        INFO("friction " << friction << ", pulled by " << pull);
        CHECK((floor.block.mean_velocity().x() - v) / 0.2 ==
              Approx(slides > 0 ? g - friction * kG : 0).epsilon(0.01).margin(0.005));
    }
}

TEST_CASE("a block hangs from a tool that it sticks to, up to its tension") {
    // 2 kPa of weight.
    for (const auto& [tension, holds] : {std::pair(2200.0, true), std::pair(1800.0, false)}) {
        Material material = kSpringy;
        material.damping_ratio = 0.2;
        material.stickiness = tension;
        OnFloor floor(make_block(4, 2, 4, 0.1, material), 0.3);
        floor.settings.gravity = Vec3(0, kG, 0);
        floor.rise = 0.4;
        floor.lift(0.09999);
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        FrameReport r;
        for (int f = 0; f < 12; ++f) {
            r = simulation.advance(floor.drive(0.05 * f), floor.drive(0.05 * (f + 1)));
        }
        INFO("tension " << tension << ": at " << floor.block.centre().y());
        CHECK((floor.block.centre().y() < 0.11) == holds);
        if (holds) {
            CHECK(r.load[0].force.y() == Approx(-floor.block.mass() * kG).epsilon(0.01));
        } else {
            CHECK(r.contact == 0);
        }
        CHECK(std::abs(r.remainder) < 0.01 * (r.gravity_work + 0.01));
    }
}

TEST_CASE("a belt drags a block along: its work is motion and friction") {
    Material material = kSpringy;
    material.damping_ratio = 0.1;
    material.friction = 0.3;
    OnFloor floor(make_block(4, 2, 4, 0.1, material), 0.3);
    floor.lift(0.1);
    const auto drive = [&](double time) {
        Drive d = floor.drive(time);
        d.gravity_strength = std::min(1.0, time / 0.3);
        d.world_from_tool[0].translation.x() = std::max(0.0, time - 0.4);
        return d;
    };
    Simulation simulation(floor.block, floor.apparatus, floor.settings);
    const FrameReport rest = [&] {
        simulation.advance(drive(0), drive(0.3));
        return simulation.advance(drive(0.3), drive(0.4));
    }();
    FrameReport r;
    for (int f = 0; f < 30; ++f) {
        r = simulation.advance(drive(0.4 + 0.02 * f), drive(0.4 + 0.02 * (f + 1)));
        // At 0.3 g it has caught up after 0.34 s, half of the belt's way behind.
        const double t = 0.02 * (f + 1);
        const double expected = std::min(1.0, 0.3 * kG * t);
        INFO("after " << t << " s");
        CHECK(floor.block.mean_velocity().x() == Approx(expected).epsilon(0.03));
    }
    const double energy = 0.5 * floor.block.mass();
    CHECK(r.kinetic == Approx(energy).epsilon(0.01));
    CHECK(r.work - rest.work == Approx(2 * energy).epsilon(0.01));
    CHECK(r.friction + r.damped - rest.damped == Approx(energy).epsilon(0.02));
    CHECK(std::abs(r.remainder - rest.remainder) < 0.01 * energy);
}

TEST_CASE("contact with tools gives equal bytes with one and two threads") {
    std::uint64_t first = 0;
    for (int threads : {1, 2}) {
        set_thread_count(threads);
        Material material = kSpringy;
        material.stickiness = 100;
        OnFloor floor(make_block(24, 3, 24, 0.1, material), 0.3);
        floor.lift(0.16);
        floor.throw_at(Vec3(1, -2, 0.5));
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        simulation.advance(floor.drive(0), floor.drive(0.05));
        const std::uint64_t hash = state_hash(floor.block);
        if (threads == 1) first = hash;
        CHECK(hash == first);
    }
    set_thread_count(0);
}

TEST_CASE("two blocks that meet part with the asked share of their speed") {
    // Slowly, so that their contacts give way by little beside a cell: deeper, points of their
    // sides are inside the other too, and pushed out sideways.
    constexpr double kSpeed = 0.1;
    for (const double e : {0.5, 0.8, 1.0}) {
        Material material = kSpringy;
        material.restitution = e;
        Aggregate low = make_block(3, 3, 3, 0.1, material), high = low;
        for (double& y : high.particle_position.y) y += 0.3005;
        for (double& v : high.particle_velocity.y) v = -kSpeed;
        SimSettings settings = motion_settings();
        settings.contact_stiffness = 0.01;
        const Apparatus nothing;
        Simulation simulation({&low, &high}, nothing, settings);
        const FrameReport r = simulation.advance(still(0), still(1));
        const auto speed = [](const Aggregate& m) {
            double sum = 0;
            for (std::size_t p = 0; p < m.particle_count(); ++p) {
                sum += m.particle_mass[p] * m.particle_velocity.y[p];
            }
            return sum / m.mass();
        };
        INFO("restitution " << e << ": " << speed(low) << " and " << speed(high));
        CHECK((speed(high) - speed(low)) / kSpeed == Approx(e).epsilon(0.03));
        CHECK((speed(high) + speed(low)) / kSpeed == Approx(-1).epsilon(1e-9));
        CHECK(r.contact == 0);
    }
}

TEST_CASE(
    "two blocks that are asked to stay together come back by less than their own elasticity") {
    // Of the speed at which they meet; the stiffer the contact, the more the blocks themselves give
    // way, and back.
    for (const auto& [stiffness, share] : {std::pair(0.01, 0.15), std::pair(0.1, 0.6)}) {
        Material material = kSpringy;
        material.restitution = 0;
        Aggregate low = make_block(3, 3, 3, 0.1, material), high = low;
        for (double& y : high.particle_position.y) y += 0.3005;
        for (double& v : high.particle_velocity.y) v = -1;
        SimSettings settings = motion_settings();
        settings.contact_stiffness = stiffness;
        const Apparatus nothing;
        Simulation simulation({&low, &high}, nothing, settings);
        simulation.advance(still(0), still(0.4));
        const double back = high.mean_velocity().y() - low.mean_velocity().y();
        INFO("contact_stiffness " << stiffness << ": " << back);
        CHECK(back > 0);
        CHECK(back < share);
    }
}

TEST_CASE("a piece that lands on the face where it was broken off lies on that face") {
    // Of a block of 3 x 7 x 3 cells the lower half stands aside.
    const double a = 0.1;
    OnFloor floor(make_block(3, 7, 3, a, kSpringy), 0.5);
    Aggregate& block = floor.block;
    break_layer(block, 3);
    const double half = 0.5 * 3 * a;
    std::vector<std::size_t> upper;
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        Vec3 x = block.particle_position.at(p);
        if (x.y() > 0) {
            x.y() += 0.05 * a;  // its face, half a cell below its particles, over the floor
            upper.push_back(p);
        } else {
            x += Vec3(20 * a, 3.5 * a + 0.05 * a, 0);
        }
        block.particle_position.set(p, x);
    }
    block.material.damping_ratio = 0.2;
    Simulation simulation(block, floor.apparatus, floor.settings);
    simulation.advance(floor.drive(0), floor.drive(1));
    double low = 1;
    Vec3 middle = Vec3::Zero();
    for (std::size_t p : upper) {
        low = std::min(low, block.particle_position.at(p).y());
        middle += block.particle_position.at(p) / double(upper.size());
    }
    CHECK(std::abs(low - 0.5 * a) < 0.05 * a);  // the face is half-way through the broken cells
    CHECK(std::abs(middle.y() - (0.5 * a + half)) < 0.05 * a);
    CHECK(std::abs(middle.x()) < 0.02 * a);
}

TEST_CASE("particles that are all that is left of cells do not fall through a floor") {
    for (const double low : {0.05, -0.03}) {  // where they are found inside it they go no deeper
        OnFloor floor(make_block(2, 5, 2, 0.1, kSpringy), 0.5);
        for (int layer : {0, 1}) break_layer(floor.block, layer);  // two sheets of particles
        floor.lift(0.25 + low);
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        const FrameReport r = simulation.advance(floor.drive(0), floor.drive(1));
        for (double y : floor.block.particle_position.y) CHECK(y > std::min(low, 0.0) - 0.01);
        CHECK(std::abs(r.remainder) < 0.01 * floor.block.mass() * kG * 0.3);
    }
}

TEST_CASE("a block topples from a sloping floor where its edge says, of two cells as of many") {
    // Twice as high as wide: its middle stands over the edge at an angle of atan(1/2), 26.57
    // degrees.
    for (const auto& [degrees, topples] : {std::pair(25.5, false), std::pair(27.5, true)}) {
        INFO(degrees);
        Material stiff = kSpringy;
        stiff.young_modulus = 1e8;
        stiff.damping_ratio = 0.05;
        OnFloor floor(make_block(2, 4, 2, 0.1, stiff), 2);
        floor.rise = 0.2;
        floor.lift(0.2);
        const double angle = degrees * kPi / 180;
        floor.settings.gravity = kG * Vec3(std::sin(angle), -std::cos(angle), 0);
        Simulation simulation(floor.block, floor.apparatus, floor.settings);
        simulation.advance(floor.drive(0), floor.drive(2));
        double lean = 0;
        for (std::size_t p = 0; p < floor.block.particle_count(); ++p) {
            const Vec3 stood = floor.block.particle_reference.at(p) + Vec3(0, 0.2, 0);
            lean = std::max(lean, (floor.block.particle_position.at(p) - stood).norm());
        }
        CHECK((lean > 0.1) == topples);
    }
}

TEST_CASE("a body that is taken back again and again does not lose sight of its tool") {
    const double spacing = 0.1;
    Aggregate m = make_block(3, 3, 3, spacing, kSpringy);
    const Apparatus apparatus = floor_with(0);
    const Drive drive = floor_at(0);
    const auto sink = [&](MovingBody& body, double way) {
        for (double& y : m.particle_position.y) y -= way * spacing;
        body.renew_candidates(drive, drive, way * spacing);
    };
    place(m, {Quat::Identity(), Vec3(0, 2.7 * spacing, 0)});  // 1.2 cells above it
    BodyOutcome outcome(apparatus, 0);
    MovingBody body(m, 0, apparatus, motion_settings());
    body.start(drive, outcome);
    for (double way : {0.44, 0.44}) {
        sink(body, way);
        MovingBody::State state;
        body.save(state);
        sink(body, 0.02);  // far enough to look for candidates
        body.restore(state, outcome);
    }
    sink(body, 0.4);  // 0.08 cells deep
    body.begin_step(drive);
    body.find_forces(drive, 1e-6, outcome);
    double push = 0;
    for (double y : body.force().y) push += y;
    CHECK(push > 1);  // [N]; what is left of inner forces is round-off
}

TEST_CASE("points together never make a layer between two cracks swing faster than asked") {
    Aggregate block = make_block(3, 3, 2, 0.1, kSpringy);
    break_layer(block, 0);
    break_layer(block, 2);
    const TouchPoints touch(block);  // before both sides of the layer, which carries them
    const SurfacePoints& points = touch.points();
    REQUIRE(points.size() > touch.own());
    const double most = 1e4;
    std::vector<double> stiffness(points.size(), 0.0);
    for (std::size_t p = touch.own(); p < points.size(); ++p) {
        if (!points.is_loose(p)) stiffness[p] = 1e5;
    }
    const std::vector<double> stiffest = stiffest_of_points(block, points, stiffness, most);
    Eigen::MatrixXd shape =
        Eigen::MatrixXd::Zero(Eigen::Index(points.size()), Eigen::Index(block.particle_count()));
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (stiffness[p] == 0) continue;
        const SurfacePoints::Carriers by = points.carriers(p);
        for (int c = 0; c < 8; ++c) {
            shape(Eigen::Index(p), by.corner[c]) +=
                by.weight[c] * std::sqrt(stiffest[p] / block.particle_mass[by.corner[c]]);
        }
    }
    const double swing = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shape * shape.transpose(),
                                                                        Eigen::EigenvaluesOnly)
                             .eigenvalues()
                             .maxCoeff();
    CHECK(swing < most * (1 + 1e-9));
    CHECK(swing > 0.1 * most);
}

TEST_CASE("a crack elsewhere changes nothing of what a step's contacts do") {
    Aggregate block = make_block(3, 6, 3, 0.1, kSpringy);
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        block.particle_position.y[p] += 0.299;
        block.particle_velocity.set(p, Vec3(0.3, -0.5, 0));
    }
    const Apparatus apparatus = floor_with(0.5);
    MovingContacts contacts(block, apparatus, motion_settings(), 0);
    contacts.limit_stiffness(block, 1e-3);
    contacts.find_candidates(block, floor_at(0));
    contacts.begin_step(floor_at(0));
    const auto push = [&](double step) {
        Vec3Array force;
        force.x = force.y = force.z = std::vector<double>(block.particle_count(), 0.0);
        contacts.add_forces(block, floor_at(1e-4), step, Vec3::Zero(), force);
        return force.y;
    };
    const std::vector<double> whole = push(1e-4);
    CHECK(push(0) == whole);
    break_layer(block, 4);
    contacts.connections_changed(block, floor_at(1e-4));
    CHECK(push(0) == whole);
}
