// SPDX-License-Identifier: GPL-3.0-or-later
// Stiff bodies that loads push onto their rests.
#include "sim/seating.h"

#include <limits>

#include "sim/advance.h"
#include "sim/resting_contacts.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSide = 0.02;  // of a cell [m]
constexpr double kWeight = 2;   // [N]

const Material kStiff{.young_modulus = 3e9, .poisson_ratio = 0.3, .density = 1200};

// A block of 3 x 2 x 3 cells, turned, near tools that stand still, with its weight on it.
struct Lying {
    Aggregate block = make_block(3, 2, 3, kSide, kStiff);
    Apparatus apparatus;
    Drive drive;
    Vec3 weight = Vec3(0, -kWeight, 0);

    void add_tool(const Shape& shape, const Pose& pose, double friction) {
        apparatus.tool.push_back({"rest", shape, friction});
        drive.world_from_tool.push_back(pose);
    }
    // There are points of the surface right above them.
    void lay_on_rolls() {
        for (double x : {-0.75 * kSide, 0.75 * kSide}) {
            add_tool(CylinderShape{0.5 * kSide, 0.5}, {Quat::Identity(), Vec3(x, -0.5 * kSide, 0)},
                     0.3);
        }
    }
    void put(const Pose& pose) {
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            block.particle_position.set(p, pose * block.particle_position.at(p));
        }
    }
    // Whether a seat was found, and what is left there to push it.
    std::pair<bool, Vec3Array> seat() {
        RestingContacts contacts(block, apparatus, SimSettings{});
        contacts.begin_move(block, drive);
        contacts.find_candidates(block, drive);
        SeatProblem problem;
        problem.add_contacts = [&](Vec3Array& force) { contacts.add_forces(block, drive, force); };
        problem.add_loads = [&](Vec3Array& force) {
            for (std::size_t p = 0; p < force.size(); ++p) {
                force.add(p, block.particle_mass[p] / block.mass() * weight);
            }
        };
        problem.held = [&] {
            return contacts.held_points(block, drive, RestingContacts::Slipping::lawful);
        };
        problem.look_around = [&] { contacts.find_candidates(block, drive); };
        problem.drag = 3e-10 * kStiff.young_modulus * kSide;
        problem.heavy = 100;
        problem.enough = 1e-3 * kWeight;
        problem.reach = 0.1;
        std::vector<ParticleId> all(block.particle_count());
        for (std::size_t p = 0; p < all.size(); ++p) all[p] = static_cast<ParticleId>(p);
        const bool found = swage::seat(block, all, problem);
        Vec3Array force;
        force.resize(all.size());
        problem.add_loads(force);
        problem.add_contacts(force);
        return {found, force};
    }
    double lowest() const {
        const auto& y = block.particle_position.y;
        return *std::min_element(y.begin(), y.end());
    }
};

const Pose kCrooked{Quat(Eigen::AngleAxisd(0.06, Vec3(2, 1, -1).normalized())),
                    Vec3(0.01, 1.2 * kSide, 0)};
const BoxShape kTable{Vec3(1, 0.2, 1), 0};
const Pose kUnder{Quat::Identity(), Vec3(0, -0.1, 0)};

}  // namespace

TEST_CASE("what is let down askew comes to lie flat and in balance, and keeps its shape") {
    for (double friction : {0.0, 0.5}) {
        Lying lying;
        lying.add_tool(kTable, kUnder, friction);
        lying.put(kCrooked);
        const Vec3Array before = lying.block.particle_position;
        const auto [found, force] = lying.seat();
        REQUIRE(found);
        Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
        const Vec3Array& x = lying.block.particle_position;
        for (std::size_t p = 0; p < x.size(); ++p) {
            sum += force.at(p);
            torque += x.at(p).cross(force.at(p));
            const std::size_t q = (7 * p + 3) % x.size();
            CHECK((x.at(p) - x.at(q)).norm() ==
                  Approx((before.at(p) - before.at(q)).norm()).margin(1e-12));
        }
        CHECK(sum.norm() < 1e-3 * kWeight);
        CHECK(torque.norm() < 1e-3 * kWeight * 0.06);
        for (std::size_t p = 0; p < x.size(); ++p) {
            if (lying.block.particle_reference.at(p).y() < -0.9 * kSide) {
                CHECK(std::abs(x.y[p]) < 1e-6 * kSide);
            }
        }
    }
}

TEST_CASE("what rests on two rolls turns until it bears on both along their length") {
    Lying lying;
    lying.lay_on_rolls();
    lying.put({Quat(Eigen::AngleAxisd(0.05, Vec3::UnitX())), Vec3(0, 1.2 * kSide, 0)});
    const auto [found, force] = lying.seat();
    REQUIRE(found);
    CHECK(lying.lowest() == Approx(0).margin(1e-6 * kSide));
    double highest = 0;
    for (std::size_t p = 0; p < lying.block.particle_count(); ++p) {
        if (lying.block.particle_reference.at(p).y() > -0.9 * kSide) continue;
        highest = std::max(highest, lying.block.particle_position.y[p]);
    }
    CHECK(highest < 1e-6 * kSide);
}

TEST_CASE("what lies askew is seated before a tool presses it onto its rest") {
    Material steel = kStiff;
    steel.young_modulus = 2e11, steel.density = 7850;
    Lying lying;
    lying.block = make_block(20, 2, 2, kSide, steel);
    lying.add_tool(kTable, kUnder, 0.3);
    lying.add_tool(kTable, {}, 0.3);
    lying.put({Quat(Eigen::AngleAxisd(0.02, Vec3::UnitZ())), Vec3(0, 1.2 * kSide, 0)});
    SimSettings settings;
    settings.gravity = {0, -9.81, 0};
    Simulation simulation(lying.block, lying.apparatus, settings);
    const auto at = [&](int n) {  // from above its highest corner to a hundredth of its height down
        Drive d = lying.drive;
        d.time = 0.1 * n;
        d.world_from_tool[1].translation.y() = 0.1 + kSide * (2.4 - 0.03 * n);
        return d;
    };
    FrameReport r;
    for (int n = 0; n < 15; ++n) r = simulation.advance(at(n), at(n + 1));
    CHECK(r.load[1].force.y() < -10 * lying.block.mass() * 9.81);
    CHECK(r.load[0].force.y() ==
          Approx(lying.block.mass() * 9.81 - r.load[1].force.y()).epsilon(0.02));
}

TEST_CASE("what has no seat is put back as it was") {
    for (const Pose& table : {Pose{Quat::Identity(), Vec3(0, -9, 0)},        // out of reach
                              Pose{Quat::Identity(), Vec3(0.57, -0.1, 0)}})  // past the middle
    {
        Lying lying;
        lying.add_tool(kTable, table, 0.3);
        lying.put({Quat::Identity(), Vec3(0, kSide, 0)});
        const Vec3Array before = lying.block.particle_position;
        const bool found = lying.seat().first;
        CHECK_FALSE(found);
        CHECK(lying.block.particle_position.x == before.x);
        CHECK(lying.block.particle_position.y == before.y);
        CHECK(lying.block.particle_position.z == before.z);
    }
}

TEST_CASE("forces that are no numbers end the search, and nothing is moved") {
    Lying lying;
    lying.add_tool(kTable, kUnder, 0.3);
    lying.put(kCrooked);
    lying.weight.y() = std::numeric_limits<double>::quiet_NaN();
    const Vec3Array before = lying.block.particle_position;
    const bool found = lying.seat().first;
    CHECK_FALSE(found);
    CHECK(lying.block.particle_position.y == before.y);
}

// The load is nothing beside the stiffness: it drives the block over thousands of times what
// it presses into its rests.
TEST_CASE("a stiff block finds its rest under next to no load") {
    Lying lying;
    lying.lay_on_rolls();
    lying.put(kCrooked);
    SimSettings settings;
    settings.gravity = Vec3(0, -1e-3, 0);
    Drive to = lying.drive;
    to.time = 1;
    lying.drive.gravity_strength = 0;
    Simulation simulation(lying.block, lying.apparatus, settings);
    const FrameReport report = simulation.advance(lying.drive, to);
    CHECK(report.iterations < 2000);
    const double weight = 1e-3 * lying.block.mass();
    const Vec3 borne = report.load[0].force + report.load[1].force;
    CHECK((borne - Vec3(0, weight, 0)).norm() < 0.02 * weight);
}
