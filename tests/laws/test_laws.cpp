// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/math.h"
#include "laws/contact.h"
#include "laws/spring_damper.h"
#include "laws/yield.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("spring tension is the gradient of its energy") {
    const SpringDamper c{350.0, 0.0, 0.7};
    for (double d : {0.2, 0.69, 0.7, 0.9, 3.0}) {
        const double h = 1e-6;
        const double slope = (spring_energy(c, d + h) - spring_energy(c, d - h)) / (2 * h);
        CHECK(spring_tension(c, d, 0.0) == Approx(slope).margin(1e-6));
    }
}

TEST_CASE("a dashpot takes energy out whichever way the ends move") {
    const SpringDamper c{1.0, 5.0, 1.0};
    for (double rate : {-3.0, 0.5}) {
        CHECK((spring_tension(c, 1.0, rate) - spring_tension(c, 1.0, 0.0)) * rate > 0);
    }
}

TEST_CASE("below the yield strain a connection forgets nothing and keeps no set") {
    CHECK(returned_strain(0.004, 0.0, 0.005) == 0.004);
    CHECK(committed_plastic_strain(0.004, 0.0, 0.005) == 0.0);
}

TEST_CASE("beyond yield the stress stays at the limit and unloading is elastic") {
    const double limit = 0.005, strain = 0.02;
    CHECK(returned_strain(strain, 0.0, limit) == Approx(limit));
    const double set = committed_plastic_strain(strain, 0.0, limit);
    CHECK(set == Approx(strain - limit));
    CHECK(returned_strain(strain - 0.001, set, limit) == Approx(limit - 0.001));
    CHECK(returned_strain(set, set, limit) == 0.0);
    CHECK(plastic_work(0.0, set, limit) == Approx(limit * set));
    CHECK(plastic_work(0.0, -set, limit) == Approx(limit * set));
}

TEST_CASE("contact pushes only inside, along the normal when nothing slides") {
    const Vec3 n = Vec3::UnitY(), x(1, -0.01, 2);
    CHECK(contact_force(0.001, n, x, x, 100, 100, 0.5).force.norm() == 0);
    const ContactForce c = contact_force(-0.01, n, x, x, 100, 100, 0.5);
    CHECK((c.force - Vec3(0, 1, 0)).norm() < 1e-15);
    CHECK_FALSE(c.slips);
}

TEST_CASE("friction never exceeds its cone, and a slipping point drags its anchor along") {
    const Vec3 n = Vec3(1, 2, 2).normalized(), x(0, 0, 0);
    const Vec3 away = Vec3(2, -1, 0).normalized();
    for (double mu : {0.0, 0.1, 0.6}) {
        for (double reach : {1e-4, 1e-2, 1.0}) {
            const ContactForce c = contact_force(-0.02, n, x, reach * away, 50, 50, mu);
            const Vec3 tangential = c.force - n * n.dot(c.force);
            CHECK(tangential.norm() <= mu * c.normal * (1 + 1e-12));
            const Vec3 anchor = dragged_anchor(c, n, x, 50);
            // From the dragged anchor the same force results, now sticking.
            const ContactForce again = contact_force(-0.02, n, x, anchor, 50, 50, mu);
            CHECK((again.force - c.force).norm() < 1e-12);
        }
    }
}
