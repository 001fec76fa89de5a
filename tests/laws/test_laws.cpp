// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "base/math.h"
#include "laws/contact.h"
#include "laws/inverse_root.h"
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

TEST_CASE("the inverse root is right to its last places at any size, lane by lane as alone") {
    for (double size : {1e-12, 1.0, 1e9}) {
        for (double q = 1; q < 4.2; q *= 1.003) {
            const double number[2] = {q * size, 1 / (q * size)};
            double y[2];
            inverse_roots(number, y);
            for (int n = 0; n < 2; ++n) {
                CHECK(std::abs(y[n] * std::sqrt(number[n]) - 1) < 1e-15);
            }
            const LanesOf<4> lanes[1] = {{number[0], number[1], 1, 2}};
            LanesOf<4> result[1];
            inverse_roots(lanes, result);
            CHECK(result[0][0] == y[0]);
            CHECK(result[0][1] == y[1]);
        }
    }
    const double zero[1] = {0.0};
    double large[1];
    inverse_roots(zero, large);
    CHECK(std::isfinite(large[0]));
}

TEST_CASE("slack is the tension over stiffness and distance") {
    const SpringDamper c{350.0, 0.0, 0.7};
    for (double d : {0.2, 0.69, 0.7, 0.9, 3.0}) {
        const double p = 0.05, reference = c.rest_length / (1 + p), y = reference / d;
        CHECK(c.stiffness * d * spring_slack(y, p) ==
              Approx(spring_tension(c, d, 0.0)).margin(1e-9));
        CHECK(spring_slack(y, p) == Approx(slack_at(d / c.rest_length - 1)).margin(1e-12));
    }
}

TEST_CASE("a dashpot takes energy out whichever way the ends move") {
    const SpringDamper c{1.0, 5.0, 1.0};
    for (double rate : {-3.0, 0.5}) {
        CHECK((spring_tension(c, 1.0, rate) - spring_tension(c, 1.0, 0.0)) * rate > 0);
    }
}

TEST_CASE("the series is the logarithm") {
    for (double r : {0.4, 0.7, 0.99, 1.0, 1.0001, 1.4, 2.5}) {
        const double bound = r < 0.7 || r > 1.4 ? 2e-4 : 1e-7;
        CHECK(log_ratio(r) == Approx(std::log(r)).margin(bound));
    }
}

TEST_CASE("inside the yield surface nothing flows, outside the stress returns to it") {
    for (double hardening : {0.0, 5e8}) {
        const Yield law{3e8, hardening, 8e10};
        const double limit = yield_distortion(law);
        CHECK(flow(law, 0.999 * limit, 0) == 0);
        CHECK(flow_share(0.999 * limit, 0) == 0);
        const double alpha = 0.02, distortion = 40 * limit;
        const double d_alpha = flow(law, distortion, alpha);
        const double kept = 1 - flow_share(distortion, d_alpha);
        const double stress = law.shear_modulus * std::sqrt(3 * kept * kept * distortion);
        CHECK(stress == Approx(law.yield_stress + hardening * (alpha + d_alpha)));
    }
}

TEST_CASE("contact pushes only inside, along the normal when nothing slides") {
    const Vec3 n = Vec3::UnitY(), x(1, -0.01, 2);
    CHECK(contact_force(0.001, n, x, x, 100, 100, 0.5).force.norm() == 0);
    const ContactForce c = contact_force(-0.01, n, x, x, 100, 100, 0.5);
    CHECK((c.force - Vec3(0, 1, 0)).norm() < 1e-15);
    CHECK_FALSE(c.slips);
}

TEST_CASE("the stiffness of a contact is that of its forces, where it sticks and where it slips") {
    const Vec3 n = Vec3(1, 2, 2).normalized(), x(0.3, -0.1, 0.2);
    const double step = 1e-6, gap = -0.02, mu = 0.4;
    for (const Vec3& reach : {Vec3(0.003, 0, -0.001), Vec3(0.2, -0.1, 0.03)}) {
        const Vec3 anchor = x + reach;
        const auto force = [&](const Vec3& way) {
            return contact_force(gap + n.dot(way), n, x + way, anchor, 70, 50, mu).force;
        };
        const Mat3 stiffness = contact_stiffness(gap, n, x, anchor, 70, 50, mu);
        CHECK(contact_force(gap, n, x, anchor, 70, 50, mu).slips == (reach.norm() > 0.1));
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3 way = step * Vec3::Unit(axis);
            const Vec3 slope = (force(way) - force(-way)) / (2 * step);
            CHECK((slope + stiffness.col(axis)).norm() < 1e-7 * 70);
        }
    }
    CHECK(contact_stiffness(0.001, n, x, x, 70, 50, mu) == Mat3(Mat3::Zero()));
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
