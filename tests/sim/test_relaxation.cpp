// SPDX-License-Identifier: GPL-3.0-or-later
// What a relaxation does to each particle in each iteration.
#include "sim/relaxation_passes.h"

#include <limits>
#include <random>

#include "sim/advance.h"
#include "sim/push_measure.h"
#include "sim/resting_contacts.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

Vec3Array random_vectors(std::size_t count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-size, size);
    Vec3Array v;
    v.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        v.x[p] = number(random), v.y[p] = number(random), v.z[p] = number(random);
    }
    return v;
}

}  // namespace

TEST_CASE("passes of a relaxation do to each particle what they say, however many there are") {
    for (const std::size_t count : {std::size_t(1), std::size_t(13), std::size_t(9001)}) {
        const Vec3Array f = random_vectors(count, 3, 1), x = random_vectors(count, 2, 2),
                        v = random_vectors(count, 1, 3), from = random_vectors(count, 2, 4);
        std::vector<double> mass, inverse, drag;
        for (std::size_t p = 0; p < count; ++p) {
            mass.push_back(p % 7 == 0 ? 0 : 0.5 + 0.001 * double(p % 100));
            inverse.push_back(mass.back() > 0 ? 1 / mass.back() : 0);
            drag.push_back(0.1 * double(p % 5));
        }
        const Vec3 gravity(1, -9.81, 0.5);
        const RelaxationMove move{0.9, 0.3, 0.7, 0.4};
        RelaxationSums sums;
        double farthest = 0;
        for (std::size_t p = 0; p < count; ++p) {
            sums.power += v.at(p).dot(f.at(p));
            sums.motion += mass[p] * v.at(p).squaredNorm();
        }
        Vec3Array pushed = f, speed = v, place = x;
        add_restraint(x, {from, drag, 0.2, mass, gravity}, pushed);
        farthest = move_on(move, f, inverse, from, speed, place);
        double most = 0, wrong = 0;
        for (std::size_t p = 0; p < count; ++p) {
            const Vec3 asked = f.at(p) + mass[p] * gravity - 0.2 * drag[p] * (x.at(p) - from.at(p));
            const Vec3 fast = 0.9 * v.at(p) + 0.3 * inverse[p] * f.at(p);
            const Vec3 there = x.at(p) + (0.7 * fast).cwiseMax(-0.4).cwiseMin(0.4);
            wrong = std::max({wrong, (pushed.at(p) - asked).norm(), (speed.at(p) - fast).norm(),
                              (place.at(p) - there).norm()});
            most = std::max(most, (there - from.at(p)).cwiseAbs().maxCoeff());
        }
        CHECK(wrong < 1e-13);
        CHECK(farthest == Approx(most));
        const RelaxationSums now = relaxation_sums(v, f, mass);
        CHECK(now.power == Approx(sums.power).margin(1e-9));
        CHECK(now.motion == Approx(sums.motion));
    }
}

TEST_CASE("points that cannot have come to a tool are passed over, and none that have") {
    Material material = kSpringy;
    Aggregate m = make_block(6, 6, 6, 0.1, material);
    Apparatus apparatus;
    apparatus.tool.push_back({"ball", SphereShape{0.25}, 0.3});
    apparatus.tool.push_back({"post", CylinderShape{0.2, 2}, 0});
    apparatus.tool.push_back({"plate", BoxShape{Vec3(2, 0.2, 2), 0.05}, 0.5});
    Drive drive = still(0);
    drive.world_from_tool = {{Quat::Identity(), Vec3(0.5, 0.1, 0)},
                             {Quat::Identity(), Vec3(-0.52, 0, 0)},
                             {Quat::Identity(), Vec3(0, -0.42, 0)}};
    const Vec3Array start = m.particle_position;
    RestingContacts contacts(m, apparatus, motion_settings(Solver::quasistatic));
    contacts.begin_move(m, drive);
    contacts.find_candidates(m, drive);
    int differ = 0, touches = 0;
    for (unsigned trial = 0; trial < 60; ++trial) {
        const double most = 0.045 * (trial + 1) / 60;
        const Vec3Array way = random_vectors(start.size(), most, trial);
        for (std::size_t p = 0; p < start.size(); ++p) {
            // Toward the tools, mostly.
            const Vec3 on = trial % 2 ? Vec3(start.x[p] > 0 ? most : -most, -most, 0) : way.at(p);
            m.particle_position.set(p, start.at(p) + on);
        }
        Vec3Array all, some;
        all.resize(start.size()), some.resize(start.size());
        contacts.add_forces(m, drive, all);
        contacts.add_forces(m, drive, some, most);
        for (std::size_t p = 0; p < start.size(); ++p) {
            differ += all.at(p) != some.at(p);
            touches += all.at(p).norm() > 0;
        }
    }
    CHECK(differ == 0);
    CHECK(touches > 1000);
    // And they are passed over: what is told to be where it was feels nothing of where it is.
    Vec3Array force;
    force.resize(start.size());
    contacts.add_forces(m, drive, force, 0);
    Vec3Array all;
    all.resize(start.size());
    contacts.add_forces(m, drive, all);
    CHECK(farthest_move(force, all) > 0);
}

TEST_CASE("a residual is eased to what was let go of, and never to what is no number") {
    PushMeasure measure(1);
    CHECK_FALSE(measure.ease(5, 0.5));
    measure.let_go(10);
    CHECK(measure.ease(5, 0.5));
    CHECK_FALSE(measure.ease(5.1, 0.5));
    for (const double none :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        CHECK_FALSE(measure.ease(none, 0.5));
    }
}

TEST_CASE("a slender bar that is slit comes back all the way, little as its stiffness drives it") {
    const double a = 0.01;
    Aggregate bar = make_block(120, 2, 2, a, {.young_modulus = 1e7, .poisson_ratio = 0.3});
    sever_plane(bar, Vec3::Zero(), Vec3::UnitY(), [](const Vec3& x) { return x.x() < -0.4; });
    Apparatus apparatus;
    apparatus.name = "hold";
    apparatus.grip.push_back(
        hold(bar, points_where(bar, [](const Vec3& x) { return x.x() < -0.585; })));
    const auto bow = [](double x) { return 0.015 * (x + 0.585) * (x + 0.585); };
    deform(bar, [&](const Vec3& x) {
        return Vec3(x + std::max(0.0, bow(std::max(x.x(), -0.585))) * Vec3::UnitY());
    });
    const double far = bow(0.6);
    Simulation simulation(bar, apparatus, SimSettings{});
    simulation.advance(drive_of(apparatus, 0, 0), drive_of(apparatus, 1, 0));
    double left = 0;
    for (std::size_t p = 0; p < bar.particle_count(); ++p) {
        left = std::max(left, (bar.particle_position.at(p) - bar.particle_reference.at(p)).norm());
    }
    INFO("bent by " << far << ", left " << left);
    CHECK(left < 0.02 * far);
}
