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
    const Aggregate block = make_block(4, 4, 4, 0.1, kSpringy),
                    other = make_block(6, 6, 6, 0.1, kSpringy);
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
