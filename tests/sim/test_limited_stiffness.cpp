// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/limited_stiffness.h"

#include "sim/body_contact.h"
#include "sim/moving_body.h"
#include "sim/moving_contacts.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Apparatus kNothing;
constexpr double kDeep = 1e-3;  // [m]

SimSettings asked(double stiffness) {
    SimSettings settings = motion_settings();
    settings.contact_stiffness = stiffness;
    return settings;
}

Vec3Array nothing(const Aggregate& matter) {
    Vec3Array force;
    force.x = force.y = force.z = std::vector<double>(matter.particle_count(), 0.0);
    return force;
}

double sum_of(const std::vector<double>& all) {
    double sum = 0;
    for (double one : all) sum += one;
    return sum;
}

// What a floor does to a cube a little deep in it, over what a layer of its cells would [1].
double at_floor(Aggregate block, double stiffness, double step) {
    place(block, {Quat::Identity(), Vec3(0, 0.2 - kDeep, 0)});
    const Apparatus apparatus = floor_with(0);
    MovingContacts contacts(block, apparatus, asked(stiffness), 0);
    contacts.limit_stiffness(block, step);
    contacts.find_candidates(block, floor_at(0));
    contacts.begin_step(floor_at(0));
    Vec3Array force = nothing(block);
    contacts.add_forces(block, floor_at(0), 1e-10, Vec3::Zero(), force);
    return sum_of(force.y) / (1e6 * 0.16 / 0.1 * kDeep);
}

// Likewise a cube on a larger one.
double on_other(Aggregate block, Aggregate other, double stiffness, double step) {
    place(other, {Quat::Identity(), Vec3(0.05, -0.3, 0.05)});
    place(block, {Quat::Identity(), Vec3(0, 0.2 - kDeep, 0)});
    BodyContact contact({&block, &other}, asked(stiffness));
    contact.limit_stiffness(step);
    contact.renew({0, 0});
    Vec3Array one = nothing(block), two = nothing(other);
    std::vector<ContactSums> sums;
    contact.add_forces({&one, &two}, Vec3::Zero(), 1e-10, {0, 0}, sums);
    return sum_of(one.y) / (0.5 * 1e6 * 0.16 / 0.1 * kDeep);
}

}  // namespace

TEST_CASE("what steps leave of a contact's stiffness is what is told, and asking more is no less") {
    Material lead = kSpringy;
    lead.density = 20 * kSpringy.density;
    const Aggregate block = make_block(4, 4, 4, 0.1, kSpringy),
                    other = make_block(6, 6, 6, 0.1, kSpringy),
                    heavy_block = make_block(4, 4, 4, 0.1, lead),
                    heavy = make_block(6, 6, 6, 0.1, lead);
    double last_at_floor = 0, last_on_other = 0;
    for (const double stiffness : {0.5, 1.0, 2.0, 5.0, 20.0, 100.0}) {
        for (const double safety : {0.8, 0.1}) {
            SimSettings settings = asked(stiffness);
            settings.step_safety = safety;
            const double step = explicit_step(block, settings);
            INFO("asked " << stiffness << " at " << safety);
            const double share = points_at_tools(block, settings, step).share();
            const double had = at_floor(block, stiffness, step);
            CHECK(had == Approx(share * stiffness).epsilon(0.02));
            const double between = points_between(block, other, settings, step).share();
            const double met = on_other(block, other, stiffness, step);
            CHECK(met == Approx(between * stiffness).epsilon(0.1));
            for (const auto& [one, two] :
                 {std::pair(block, heavy), std::pair(heavy_block, other)}) {
                const double told = points_between(one, two, settings, step).share();
                CHECK(on_other(one, two, stiffness, step) == Approx(told * stiffness).epsilon(0.1));
            }
            if (safety < 0.8) continue;
            CHECK(had >= last_at_floor * (1 - 1e-9));
            CHECK(met >= last_on_other * (1 - 1e-9));
            last_at_floor = had, last_on_other = met;
            CHECK(points_at_tools(block, settings, step).share(8) ==
                  Approx(points_at_tools(block, settings, step / 8).share()));
        }
    }
    CHECK(last_at_floor < 2);  // so it was held back
}

// 1.28 J or 1.28 mJ come with the one that moves.
TEST_CASE("a stiff, heavy body and a light one press each other no harder than steps can follow") {
    const auto cube = [](double modulus, double density) {
        Material material = kSpringy;
        material.young_modulus = modulus;
        material.density = density;
        material.restitution = 1;
        return make_block(3, 3, 3, 0.08 / 3, material);
    };
    for (const bool heavy_moves : {true, false}) {
        long steps_at_default = 0;
        for (const double stiffness : {2.0, 20.0, 100.0}) {
            CAPTURE(heavy_moves, stiffness);
            long steps = 0;
            for (const double above : {0.0801, 0.0804, 0.0807, 0.081, 0.0813}) {
                CAPTURE(above);
                Aggregate light = cube(1e5, 20), heavy = cube(1e7, 20000);
                place(heavy, {Quat::Identity(), Vec3(0.003, above, 0.002)});
                for (double& v : (heavy_moves ? heavy : light).particle_velocity.y) {
                    v = heavy_moves ? -0.5 : 0.5;
                }
                Simulation simulation({&light, &heavy}, kNothing, asked(stiffness));
                FrameReport last;
                for (int n = 0; n < 10; ++n) {
                    last = simulation.advance(still(0.004 * n), still(0.004 * (n + 1)));
                    steps += last.steps + last.rejected;
                }
                const Books& own = last.body[0];
                CHECK(std::abs(last.remainder) < 0.04 * (own.kinetic + own.elastic));
            }
            if (stiffness == 2) steps_at_default = steps;
            CHECK(steps == steps_at_default);
        }
    }
}
