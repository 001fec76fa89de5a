// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    double size = 0, turn = 0;
};

Momenta momenta(const std::vector<const Aggregate*>& bodies) {
    Momenta sum;
    for (const Aggregate* m : bodies) {
        for (std::size_t p = 0; p < m->particle_count(); ++p) {
            const Vec3 mv = m->particle_mass[p] * m->particle_velocity.at(p);
            sum.linear += mv;
            sum.angular += m->particle_position.at(p).cross(mv);
            sum.size += mv.norm();
            sum.turn += m->particle_position.at(p).cross(mv).norm();
        }
    }
    return sum;
}

// A held floor and what moves on it.
struct Floor {
    Aggregate plate, block;
    Apparatus apparatus;
    SimSettings settings = motion_settings();
    Pose pose{Quat::Identity(), Vec3(0, -0.1, 0)};
    double let_down = 0.3;  // [s] over which gravity sets in

    Floor(const Material& of_plate, const Material& of_block, const Vec3& gravity)
        : plate(make_block(8, 2, 4, 0.1, of_plate)), block(make_block(3, 2, 3, 0.1, of_block)) {
        place(plate, pose);
        settings.gravity = gravity;
        Grip hold;
        hold.name = "hold";
        hold.point = points_where(plate, [](const Vec3& x) { return x.y() < -0.0999; });
        for (int p : hold.point) hold.anchor.push_back(plate.surface_reference(p));
        apparatus.name = "floor";
        apparatus.grip.push_back(hold);
        place(block, {Quat::Identity(), Vec3(0, 0.09999, 0)});
    }
    Drive drive(double time) const {
        Drive d = still(time);
        d.world_from_grip.push_back(pose);
        d.gravity_strength = std::min(1.0, time / let_down);
        return d;
    }
};

}  // namespace

TEST_CASE("a tumbling collision keeps momentum and angular momentum") {
    Material m = kSpringy;
    m.restitution = 0.7;
    Aggregate a = make_block(5, 2, 2, 0.1, m), b = make_block(3, 3, 3, 0.09, m);
    place(b, {Quat(Eigen::AngleAxisd(0.6, Vec3(1, 1, 0.3).normalized())), Vec3(0.15, 0.32, 0.05)});
    for (std::size_t p = 0; p < a.particle_count(); ++p) {
        a.particle_velocity.set(p, Vec3(0, 2, 0) + Vec3(0, 0, 6).cross(a.particle_position.at(p)));
    }
    for (std::size_t p = 0; p < b.particle_count(); ++p) {
        b.particle_velocity.set(p, Vec3(-0.5, -3, 0));
    }
    const Momenta before = momenta({&a, &b});
    const double energy = kinetic_energy(a) + kinetic_energy(b);
    const Apparatus nothing;
    Simulation simulation({&a, &b}, nothing, motion_settings());
    FrameReport r;
    long steps = 0;
    for (int f = 0; steps < 10'000; ++f) {
        r = simulation.advance(still(0.1 * f), still(0.1 * (f + 1)));
        steps += r.steps;
        CHECK(r.kinetic + r.elastic < 1.001 * energy);
    }
    const Momenta after = momenta({&a, &b});
    CHECK((a.mean_velocity() - Vec3(0, 2, 0)).norm() > 0.5);
    CHECK(r.kinetic + r.elastic < 0.95 * energy);
    CHECK((after.linear - before.linear).norm() < 1e-9 * before.size);
    CHECK((after.angular - before.angular).norm() < 1e-9 * before.turn);
}

TEST_CASE("bodies that collide part, and neither passes through the other") {
    for (double e : {0.0, 0.5, 1.0}) {
        Material m = kSpringy;
        m.restitution = e;
        Aggregate a = make_block(3, 3, 3, 0.1, m), b = make_block(3, 3, 3, 0.1, m);
        place(b, {Quat::Identity(), Vec3(0.02, 0.32, 0.01)});
        for (std::size_t p = 0; p < b.particle_count(); ++p) {
            b.particle_velocity.set(p, Vec3(0, -2, 0));
        }
        const Apparatus nothing;
        Simulation simulation({&a, &b}, nothing, motion_settings());
        double nearest = 1;
        for (int f = 0; f < 60; ++f) {
            simulation.advance(still(0.002 * f), still(0.002 * (f + 1)));
            nearest = std::min(nearest, b.centre().y() - a.centre().y());
        }
        const double parting = b.mean_velocity().y() - a.mean_velocity().y();
        INFO("e " << e << ", parting " << parting << ", nearest " << nearest);
        CHECK(nearest > 0.24);
        CHECK(parting > 0);
        CHECK(parting < 2.001);
    }
}

TEST_CASE("particles that are all that is left of cells do not fall through another body") {
    Floor floor(kSpringy, kSpringy, Vec3(0, -9.81, 0));
    floor.let_down = 0.01;
    floor.settings.step_safety = 0.2;  // the books' remainder is of second order in it
    Aggregate& block = floor.block = make_block(2, 5, 2, 0.1, kSpringy);
    for (int layer : {0, 1}) break_layer(block, layer);  // two sheets of particles
    place(block, {Quat::Identity(), Vec3(0, 0.3, 0)});
    Simulation simulation({&floor.plate, &block}, floor.apparatus, floor.settings);
    FrameReport r;
    for (int f = 0; f < 50; ++f) {
        r = simulation.advance(floor.drive(0.02 * f), floor.drive(0.02 * (f + 1)));
        for (double y : block.particle_position.y) CHECK(y > -0.02);
    }
    CHECK(std::abs(r.remainder) < 0.01 * block.mass() * 9.81 * 0.3);
}

TEST_CASE("particles that are all that is left of cells do not pass through what they broke off",
          "[stress]") {
    for (Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        Aggregate block = make_block(3, 5, 3, 0.1, kSpringy);
        break_layer(block, 0);  // a sheet of particles below
        const auto is_sheet = [&](std::size_t p) {
            return block.particle_reference.at(p).y() < -0.2;
        };
        double sheet = 0;  // mass
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            if (!is_sheet(p)) continue;
            sheet += block.particle_mass[p];
            block.particle_velocity.set(p, Vec3(0, 1, 0));
        }
        SimSettings settings = motion_settings(solver);
        settings.self_contact = true;
        settings.step_safety = 0.4;
        const Apparatus nothing;
        Simulation simulation(block, nothing, settings);
        FrameReport r;
        for (int f = 0; f < 40; ++f) {
            r = simulation.advance(still(0.01 * f), still(0.01 * (f + 1)));
            double low = 1, high = -1;
            for (std::size_t p = 0; p < block.particle_count(); ++p) {
                const double y = block.particle_position.y[p];
                is_sheet(p) ? high = std::max(high, y) : low = std::min(low, y);
            }
            CHECK(high < low);
        }
        CHECK(std::abs(r.remainder) < 0.01 * 0.5 * sheet);
    }
}

TEST_CASE("what breaks where another strikes it neither gains nor loses energy by it") {
    for (double friction : {0.0, 0.5}) {
        const double speed = 20;
        const Material whole{.young_modulus = 5e8,
                             .poisson_ratio = 0.2,
                             .density = 1200,
                             .damping_ratio = 0,
                             .friction = friction,
                             .restitution = 1};
        Material brittle = whole;
        brittle.strength = 1e6;
        brittle.toughness = 40;
        Aggregate board = make_block(20, 2, 8, 0.005, brittle),
                  block = make_block(5, 4, 5, 0.007, whole);
        const Quat askew(Eigen::AngleAxisd(0.3, Vec3(1, 0.2, 0.3).normalized()));
        place(block, {askew, Vec3(0, 0.032, 0)});
        for (double& v : block.particle_velocity.y) v = -speed;
        SimSettings settings = motion_settings();
        settings.step_safety = 0.4;
        const Apparatus nothing;
        Simulation simulation({&board, &block}, nothing, settings);
        FrameReport r;
        for (int f = 0; f < 3; ++f) {
            r = simulation.advance(still(5e-4 * f), still(5e-4 * (f + 1)));
        }
        const double energy = 0.5 * block.mass() * speed * speed;
        INFO("friction " << friction << ", pieces " << r.pieces);
        CHECK(r.pieces > 50);
        CHECK(r.fracture > 0.02 * energy);
        CHECK(std::abs(r.remainder) < 0.005 * energy);
        CHECK(r.friction >= -1e-3 * energy);
    }
}

TEST_CASE("steps that energy chooses let bodies meet as explicit ones do") {
    struct Met {
        double start;  // energy [J]
        Vec3 a{}, b{};
        FrameReport last{};
    };
    const auto collide = [](Solver solver) {
        Material dull = kSpringy;
        dull.restitution = 0.5;
        dull.friction = 0.4;
        dull.damping_ratio = 0.1;
        Aggregate a = make_block(2, 2, 2, 0.1, dull), b = make_block(2, 2, 2, 0.1, dull);
        place(b,
              {Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())), Vec3(0.32, 0.06, 0.05)});
        for (std::size_t p = 0; p < b.particle_count(); ++p) b.particle_velocity.x[p] = -2;
        const Apparatus nothing;
        SimSettings settings = motion_settings(solver);
        settings.step_safety = 0.02;
        Simulation simulation({&a, &b}, nothing, settings);
        Met met{.start = 0.5 * b.mass() * 4};
        for (int n = 0; n < 6; ++n) {
            met.last = simulation.advance(still(0.01 * n), still(0.01 * (n + 1)));
        }
        met.a = a.mean_velocity(), met.b = b.mean_velocity();
        return met;
    };
    const Met fixed = collide(Solver::explicit_steps), chosen = collide(Solver::energy_stepped);
    CHECK((fixed.a - chosen.a).norm() < 0.01);
    CHECK((fixed.b - chosen.b).norm() < 0.01);
    CHECK(chosen.last.friction == Approx(fixed.last.friction).epsilon(0.02));
    CHECK(chosen.last.damped == Approx(fixed.last.damped).epsilon(0.02));
    CHECK(std::abs(chosen.last.remainder) < 2e-3 * chosen.start);
    CHECK(
        chosen.last.body[0].passed + chosen.last.body[1].passed ==
        Approx(fixed.last.body[0].passed + fixed.last.body[1].passed).margin(0.03 * chosen.start));
}

TEST_CASE("steps that energy chooses go on where friction, or what sticks, lets go at once") {
    Material dull = kSpringy;  // dashpots hold points beyond what friction can
    dull.restitution = 0.5;
    dull.friction = 0.3;
    Material holding = kSpringy;  // what begins to slide lets go of half
    holding.restitution = 1;
    holding.friction = 0.3, holding.static_friction = 0.6;
    Material sticky = kSpringy;
    sticky.restitution = 1;
    sticky.friction = 0;
    sticky.stickiness = 3000;
    for (const Material& material : {dull, holding, sticky}) {
        Aggregate a = make_block(3, 3, 3, 0.033, material), b = a;
        place(b,
              {Quat(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized())), Vec3(0.15, 0.02, 0.03)});
        for (double& v : b.particle_velocity.x) v = -4;
        const double energy = 0.5 * b.mass() * 16;
        const Apparatus nothing;
        Simulation simulation({&a, &b}, nothing, motion_settings(Solver::energy_stepped));
        FrameReport last;
        double met = 0, friction = 0;
        for (int n = 0; n < 10; ++n) {
            last = simulation.advance(still(0.004 * n), still(0.004 * (n + 1)));
            met = std::max(met, last.contact);
            CHECK(last.friction > friction - 1e-6 * energy);
            friction = last.friction;
        }
        INFO(last.remainder / energy << ", friction " << last.friction / energy);
        CHECK(met > 0.01 * energy);
        CHECK(last.contact == 0);  // they have parted
        CHECK(std::abs(last.remainder) < 1e-3 * energy);
    }
}

TEST_CASE("steps that energy chooses part all that a stage begins with pressed") {
    Aggregate a = make_block(3, 3, 3, 0.1, kSpringy);
    std::vector<Aggregate> body(4, a);  // two pairs, far from each other
    for (int n = 1; n < 4; ++n) {
        place(body[n], {Quat::Identity(), Vec3(n % 2 * 0.29, n % 2 * 0.02, n / 2 * 64)});
    }
    const Apparatus nothing;
    Simulation simulation({&body[0], &body[1], &body[2], &body[3]}, nothing,
                          motion_settings(Solver::energy_stepped));
    const FrameReport r = simulation.advance(still(0), still(0.02));
    const auto apart = [&](int n) {
        return (body[n + 1].mean_velocity() - body[n].mean_velocity()).x();
    };
    double moving = 0;
    for (const Books& books : r.body) moving += books.kinetic;
    CHECK(r.rejected > 0);
    CHECK(apart(0) > 0.1);
    CHECK(apart(2) == Approx(apart(0)).epsilon(1e-3));
    CHECK(std::abs(r.remainder) < 1e-3 * moving);
}

TEST_CASE("steps that energy chooses go on where they take back what has broken") {
    Material brittle = kSpringy;
    brittle.restitution = 0.5;
    const Material whole = brittle;
    brittle.strength = 2e4, brittle.toughness = 1;
    Aggregate a = make_block(4, 3, 3, 0.1, brittle), b = make_block(2, 2, 2, 0.1, whole);
    place(b, {Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())), Vec3(0.05, 0.32, 0.03)});
    for (double& v : b.particle_velocity.y) v = -2;
    SimSettings settings = motion_settings(Solver::energy_stepped);
    settings.step_safety = 0.2;
    const Apparatus nothing;
    Simulation simulation({&a, &b}, nothing, settings);
    FrameReport last;
    long rejected = 0;
    // With cells that contact still took for broken it stopped at 34 ms.
    for (int n = 0; n < 5; ++n) {
        last = simulation.advance(still(0.01 * n), still(0.01 * (n + 1)));
        rejected += last.rejected;
    }
    CHECK(last.pieces > 2);
    CHECK(rejected > 0);
    CHECK(std::abs(last.remainder) < 0.05 * 0.5 * b.mass() * 4);
}

TEST_CASE("a block on another body stays below static friction and slides above") {
    Material smooth = kSpringy, even = kSpringy, rough = kSpringy;
    smooth.damping_ratio = even.damping_ratio = rough.damping_ratio = 0.1;
    smooth.friction = 0.1, smooth.static_friction = 0.2;
    even.friction = 0.3, even.static_friction = 0.45;
    rough.friction = 0.5, rough.static_friction = 0.7;
    struct Case {
        Material plate, block;  // alike, or of this mean, which acts
        bool leans;
    };
    const double g = 9.81;
    // Pushed along the face that touches, so that it does not topple; then on a slope, which is a
    // level where gravity leans.
    for (const auto& [of_plate, of_block, leans] :
         {Case{even, even, true}, {smooth, rough, false}, {rough, smooth, false}}) {
        for (const auto& [share, slides] : {std::pair(0.441, false), std::pair(0.459, true)}) {
            const double down = leans ? g / std::hypot(1, share) : g;
            Floor floor(of_plate, of_block, Vec3(0, -down, 0));
            Load push = push_below(floor.block, share * floor.block.mass() * down);
            if (leans) {
                const double points = static_cast<double>(floor.block.surface.size());
                push.point.clear();
                for (int p = 0; p < points; ++p) push.point.push_back(p);
                push.force.assign(push.point.size(),
                                  Vec3(share * floor.block.mass() * down / points, 0, 0));
            }
            push.body = 1;
            floor.apparatus.load.push_back(push);
            const auto drive = [&](double time) {
                Drive d = floor.drive(time);
                d.load_strength = {std::clamp((time - 0.4) / 0.3, 0.0, 1.0)};
                return d;
            };
            Simulation simulation({&floor.plate, &floor.block}, floor.apparatus, floor.settings);
            simulation.advance(drive(0), drive(0.3));
            simulation.advance(drive(0.3), drive(0.4));
            const double rest = floor.block.centre().x();
            simulation.advance(drive(0.4), drive(0.7));
            simulation.advance(drive(0.7), drive(1.0));
            const double v = floor.block.mean_velocity().x();
            simulation.advance(drive(1.0), drive(1.2));
            const double gained = (floor.block.mean_velocity().x() - v) / 0.2;
            INFO("plate's " << of_plate.friction << ", leans " << leans << ", push " << share
                            << ", from " << rest << " to " << floor.block.centre().x()
                            << ", gained " << gained);
            if (slides) {
                CHECK(gained == Approx(down * (share - 0.3)).epsilon(0.01));
            } else {
                CHECK(std::abs(floor.block.centre().x() - rest) < 1e-3);
                CHECK(std::abs(floor.block.mean_velocity().x()) < 2e-3);
            }
        }
    }
}

TEST_CASE("sticking lumps hold below the mean of their tensions and part above it") {
    struct Case {
        double plate, block;  // [Pa]
        bool holds;
    };
    for (const auto& [of_plate, of_block, holds] : {Case{5000, 5000, true},
                                                    {5000, 0, true},
                                                    {0, 5000, true},
                                                    {1400, 1400, false},
                                                    {3000, 0, false},
                                                    {0, 3000, false}}) {
        Material low = kSpringy;
        low.young_modulus = 3e5;
        low.damping_ratio = 0.1;
        Material high = low;
        high.stickiness = of_plate, low.stickiness = of_block;
        // The block hangs below the plate: 2 kPa.
        Floor floor(high, low, Vec3(0, 9.81, 0));
        Simulation simulation({&floor.plate, &floor.block}, floor.apparatus, floor.settings);
        for (int f = 0; f < 12; ++f) {
            simulation.advance(floor.drive(0.05 * f), floor.drive(0.05 * (f + 1)));
        }
        INFO("tensions " << of_plate << " and " << of_block << ": " << floor.block.centre().y());
        if (holds) {
            CHECK(floor.block.centre().y() == Approx(0.1).margin(0.01));
        } else {
            CHECK(floor.block.centre().y() > 0.2);
        }
    }
}

TEST_CASE("of two unlike bodies the one that gives way more says more of what comes back") {
    constexpr double kSpeed = 0.1;
    for (const bool soft_is_dull : {false, true}) {
        for (const bool turned : {false, true}) {
            Material soft = kSpringy, hard = kSpringy;
            hard.young_modulus = 8 * soft.young_modulus;
            soft.restitution = soft_is_dull ? 0.3 : 1;
            hard.restitution = soft_is_dull ? 1 : 0.3;
            Aggregate low = make_block(2, 2, 2, 0.1, soft), high = make_block(2, 2, 2, 0.1, hard);
            place(high, {Quat::Identity(), Vec3(0, 0.2005, 0)});
            for (double& v : high.particle_velocity.y) v = -kSpeed;
            SimSettings settings = motion_settings();
            settings.contact_stiffness = 0.01;  // so that contacts give way more than the blocks
            const Apparatus nothing;
            std::vector<Aggregate*> bodies{&low, &high};
            if (turned) std::swap(bodies[0], bodies[1]);
            Simulation simulation(bodies, nothing, settings);
            simulation.advance(still(0), still(0.8));
            // Each gives back of the energy in its part of the give: 8 to 1.
            const double e =
                std::sqrt((8 * std::pow(soft.restitution, 2) + std::pow(hard.restitution, 2)) / 9);
            const double back = high.mean_velocity().y() - low.mean_velocity().y();
            INFO("soft is dull " << soft_is_dull << ", turned " << turned);
            CHECK(back / kSpeed == Approx(e).epsilon(0.05));
        }
    }
}

TEST_CASE("contact gives equal bytes at any number of threads and width of vectors") {
    std::uint64_t first = 0;
    for (const auto& [threads, width] : {std::pair(1, 0), std::pair(2, 0), std::pair(1, 2)}) {
        set_thread_count(threads);
        limit_vector_width(width);
        Aggregate a = make_block(12, 12, 12, 0.05, kSpringy),
                  b = make_block(12, 12, 12, 0.05, kSpringy);
        place(b, {Quat(Eigen::AngleAxisd(0.2, Vec3::UnitX())), Vec3(0.03, 0.64, 0.02)});
        for (std::size_t p = 0; p < b.particle_count(); ++p) {
            b.particle_velocity.set(p, Vec3(0.4, -3, 0));
        }
        SimSettings settings = motion_settings();
        settings.self_contact = true;
        const Apparatus nothing;
        Simulation simulation({&a, &b}, nothing, settings);
        simulation.advance(still(0), still(0.03));
        const std::uint64_t hash = state_hash(a) ^ (state_hash(b) << 1);
        if (first == 0) first = hash;
        CHECK(hash == first);
        CHECK(a.mean_velocity().norm() > 0.01);
    }
    set_thread_count(0);
    limit_vector_width(0);
}
