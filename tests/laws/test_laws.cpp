// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <random>

#include "base/math.h"
#include "laws/contact.h"
#include "laws/inverse_root.h"
#include "laws/spring_damper.h"
#include "laws/yield.h"
#include "matter/lattice.h"
#include "matter/spring_layout.h"
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

namespace {

// A cell of springs that is stretched by U and then turned, as it was molded otherwise.
struct StrainedCell {
    CellSprings<double> springs;
};
struct Flowed {
    bool flows;
    SpringReturn<double> by;
};
Flowed return_springs(const Yield& law, const StrainedCell& cell, double alpha) {
    Flowed r{};
    r.flows = return_springs<double>(law, cell.springs, kSpringLayout, 0, alpha, true, r.by);
    return r;
}
StrainedCell strained_cell(const Mat3& gradient) {
    StrainedCell cell;
    for (int slot = 0; slot < 24; ++slot) {
        const auto& way = kForward[kCellConnection[slot].direction];
        const Vec3 n = Vec3(way[0], way[1], way[2]).normalized();
        const Vec3 lies = gradient * n;
        cell.springs.way[slot] = {lies.x(), lies.y(), lies.z()};
        cell.springs.strain[slot] = std::log((gradient * n).norm());
    }
    return cell;
}

}  // namespace

TEST_CASE("springs inside the yield surface do not flow, outside their stress returns to it") {
    const Vec3 stretch = Vec3(1.02, .99, 1 / (1.02 * .99));
    const Quat turn(Eigen::AngleAxisd(.7, Vec3(1, 2, -1).normalized()));
    const Mat3 gradient = turn * stretch.asDiagonal() * turn.conjugate();
    const StrainedCell cell = strained_cell(gradient);
    const double shear = 8e10;
    const SpringFrame<double> frame = frame_of(cell.springs, kSpringLayout);
    const auto stress_of = [&](const Springs& strain) {
        return frame.distortion(strain).stress(shear);
    };
    const double q = stress_of(cell.springs.strain);
    const Vec3 log = stretch.array().log();
    CHECK(q == Approx(2 * shear * std::sqrt(1.5) * log.norm()).epsilon(.05));
    for (double hardening : {0.0, 5e8}) {
        CHECK_FALSE(return_springs({1.001 * q, hardening, shear}, cell, 0).flows);
        const Yield law{0.1 * q, hardening, shear};
        const double alpha = 0.02;
        const auto [flows, flow] = return_springs(law, cell, alpha);
        REQUIRE(flows);
        Springs left = cell.springs.strain;
        double taken = 0;
        for (int b = 0; b < 24; ++b) {
            left[b] -= flow.grows[b];
            taken += frame.weight(b) * left[b] * flow.grows[b];
        }
        const double stress = stress_of(left);
        CHECK(stress == Approx(flow_stress(law, alpha + flow.d_alpha).stress).epsilon(1e-9));
        CHECK(shear * taken == Approx(stress * flow.d_alpha).epsilon(.03));
        CHECK(flow.d_alpha ==
              Approx(std::sqrt(2. / 3) * log.norm() * (1 - stress / q)).epsilon(.01));
    }
}

TEST_CASE("the bound by which springs are passed over is one, and close where none has flowed") {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> draw(-1, 1);
    double closest = 0;
    for (int round = 0; round < 20000; ++round) {
        const double far = 0.8 * std::abs(draw(engine)) * (round % 4 > 0);
        const double size = std::pow(10, -4 + 3 * std::abs(draw(engine)));
        Mat3 gradient;
        for (int n = 0; n < 9; ++n) gradient(n / 3, n % 3) = far * draw(engine) + (n % 4 == 0);
        if (gradient.determinant() < 0.01) continue;
        StrainedCell cell = strained_cell(gradient);
        const auto [shortest, longest] =
            std::minmax_element(cell.springs.strain.begin(), cell.springs.strain.end());
        const double low = *shortest, high = *longest;
        const double theta = size * draw(engine) * (round % 2 ? 1 : 20);
        double distortion = 0;
        for (int b = 0; b < 24; ++b) {
            const double off = round % 5 > 0 ? size * draw(engine) : 0;
            cell.springs.strain[b] = theta + off;
            distortion += kSpringLayout.share[b] * off * off;
        }
        const double q =
            frame_of(cell.springs, kSpringLayout).distortion(cell.springs.strain).stress(1);
        const double bound = most_stress(distortion, theta, low, high);
        CHECK(q <= bound * (1 + 1e-9) + 1e-5 * size);  // round-off of t^2 <i, i>
        if (round % 5 > 0) closest = std::max(closest, q / bound);
    }
    CHECK(closest > 0.99);
}

TEST_CASE("what springs flow never gives energy, however they lie") {
    std::mt19937 engine(11);
    std::uniform_real_distribution<double> draw(-1, 1);
    int flowed = 0;
    for (int round = 0; round < 300; ++round) {
        Mat3 gradient;
        for (int n = 0; n < 9; ++n) gradient(n / 3, n % 3) = draw(engine) + (n % 4 == 0);
        StrainedCell cell = strained_cell(gradient);
        for (double& strain : cell.springs.strain) strain = 0.02 * draw(engine);
        const auto [flows, flow] = return_springs({1e6, 0, 1e9}, cell, 0);
        if (!flows) continue;
        ++flowed;
        double taken = 0, all = 0;
        for (int b = 0; b < 24; ++b) {
            const double c = kSpringLayout.share[b] * dot(cell.springs.way[b], cell.springs.way[b]);
            taken += c * (cell.springs.strain[b] - 0.5 * flow.grows[b]) * flow.grows[b];
            all += c * cell.springs.strain[b] * cell.springs.strain[b];
        }
        CHECK(taken > 0);
        CHECK(taken <= 0.5 * all * (1 + 1e-9));
    }
    CHECK(flowed > 200);
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
