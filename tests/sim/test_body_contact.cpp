// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/body_contact.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

// What contact alone does at the present positions.
struct Pressed {
    std::vector<Vec3Array> force;
    std::vector<ContactSums> sums;
    Vec3 total(std::size_t b) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t p = 0; p < force[b].size(); ++p) sum += force[b].at(p);
        return sum;
    }
};

Pressed pressed(const std::vector<Aggregate*>& bodies, SimSettings settings = motion_settings()) {
    BodyContact contact(bodies, settings);
    const std::vector<char> asleep(bodies.size(), 0);
    contact.renew(asleep);
    Pressed result;
    std::vector<Vec3Array*> force;
    for (Aggregate* m : bodies) {
        Vec3Array f;
        f.x = f.y = f.z = std::vector<double>(m->particle_count(), 0.0);
        result.force.push_back(std::move(f));
    }
    for (Vec3Array& f : result.force) force.push_back(&f);
    contact.add_forces(force, Vec3::Zero(), 1e-10, asleep, result.sums);
    return result;
}

}  // namespace

TEST_CASE("what is in balance stays so: dashpots bear nothing of what rests") {
    Material dull = kSpringy;
    dull.restitution = 0.2;
    Aggregate a = make_block(3, 3, 3, 0.1, dull), b = make_block(4, 4, 4, 0.09, dull);
    place(a, {Quat(Eigen::AngleAxisd(0.03, Vec3(1, 0, 2).normalized())), Vec3(0.02, 0.323, 0)});
    BodyContact contact({&a, &b}, motion_settings());
    const std::vector<char> asleep(2, 0);
    contact.renew(asleep);
    const auto forces = [&](std::vector<Vec3Array> others) {
        std::vector<Vec3Array*> force{&others[0], &others[1]};
        std::vector<ContactSums> sums;
        contact.add_forces(force, Vec3::Zero(), 1e-3, asleep, sums);
        CHECK(sums[0].contacts > 3);
        return others;
    };
    // At rest nothing but the springs act once all that they do is borne.
    Pressed springs = pressed({&a, &b});
    const double size = springs.total(0).norm();
    for (Vec3Array& f : springs.force) {
        for (std::size_t p = 0; p < f.size(); ++p) f.set(p, -f.at(p));
    }
    for (const Vec3Array& left : forces(springs.force)) {
        for (std::size_t p = 0; p < left.size(); ++p) CHECK(left.at(p).norm() < 1e-4 * size);
    }
}

TEST_CASE("two blocks press on each other as both tools' springs in series") {
    for (double stiffer : {1.0, 10.0}) {
        Material hard = kSpringy;
        hard.young_modulus *= stiffer;
        Aggregate a = make_block(5, 6, 5, 0.1, kSpringy), b = make_block(6, 6, 6, 0.1, hard);
        const double depth = 0.003, area = 0.25;
        place(a, {Quat::Identity(), Vec3(0, 0.6 - depth, 0)});
        const Pressed p = pressed({&a, &b});
        const double k = 2 * 1e6 * area / 0.1;
        const double series = 1 / (1 / k + 1 / (k * stiffer));
        CHECK(p.total(0).y() == Approx(series * depth).epsilon(1e-6));
        CHECK((p.total(0) + p.total(1)).norm() < 1e-13 * p.total(0).norm());
        CHECK(std::abs(p.total(0).x()) < 1e-9 * p.total(0).norm());
        CHECK(p.sums[0].penetration == Approx(depth).epsilon(1e-6));
    }
}

TEST_CASE("parts of one body press on each other as two bodies do") {
    const auto block = [](const Vec3& x, double low, double half) {
        return (Vec3(x.x(), x.y() - low - 0.3, x.z()).cwiseAbs() - Vec3(half, 0.3, half))
            .maxCoeff();
    };
    Aggregate both =
        make_shape([&](const Vec3& x) { return std::min(block(x, 0, 0.35), block(x, 1, 0.25)); },
                   Vec3(-0.35, 0, -0.35), Vec3i(7, 16, 7), 0.1);
    both.material = kSpringy;
    const double depth = 0.003;
    for (std::size_t p = 0; p < both.particle_count(); ++p) {
        if (both.particle_reference.at(p).y() > 0.8) {
            both.particle_position.add(p, Vec3(0.031, -0.4 - depth, 0.043));
        }
    }
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    const Pressed p = pressed({&both}, settings);
    double on_upper = 0;
    for (std::size_t n = 0; n < both.particle_count(); ++n) {
        if (both.particle_reference.at(n).y() > 0.8) on_upper += p.force[0].y[n];
    }
    const double k = 2 * 1e6 * 0.25 / 0.1;
    CHECK(on_upper == Approx(0.5 * k * depth).epsilon(0.03));
}

TEST_CASE("a small block presses on a face alike on its points and between them", "[stress]") {
    Material m = kSpringy;
    m.friction = 0;
    Aggregate big = make_block(6, 3, 6, 0.1, m), small = make_block(2, 2, 2, 0.02, m);
    const double depth = 0.002, height = 0.15 + 0.02;
    const auto put = [&](double x, double y, double z) {
        place(small, {Quat::Identity(), Vec3(x, height + y, z)});
    };
    const double k = 2 * 1e6 / (0.1 + 0.02) * 0.04 * 0.04;
    const double least = 1e-3;  // that either way keeps of what both do
    const double alone = (std::pow(2, -0.25) + least) / (1 + 2 * least);
    put(0.001, -depth, 0.002);  // none of the face's points below it
    CHECK(pressed({&small, &big}).total(0).y() == Approx(alone * k * depth));
    // The same whichever comes first.
    CHECK(pressed({&big, &small}).total(1).y() == Approx(alone * k * depth));
    put(0.026, -depth, 0.024);  // one, which stands for a larger square
    CHECK(pressed({&small, &big}).total(0).y() == Approx(alone * k * depth).epsilon(0.03));

    // Down between the points, along to one of them and up: what it took it gives back.
    const int steps = 200;
    double work = 0, most = 0;
    Vec3 last = Vec3::Zero(), f_last = Vec3::Zero();
    const auto way = [&](Vec3 from, Vec3 to) {
        for (int n = 0; n <= steps; ++n) {
            const Vec3 x = from + (to - from) * n / steps;
            put(x.x(), x.y(), x.z());
            const Vec3 f = pressed({&small, &big}).total(0);
            work += 0.5 * (f + f_last).dot(x - last);
            last = x;
            f_last = f;
            most = std::max(most, -work);
        }
    };
    last = Vec3(0.001, 0.001, 0.002);
    way(last, {0.001, -depth, 0.002});
    way(last, {0.041, -depth, 0.032});
    way(last, {0.041, 0.001, 0.032});
    INFO("work " << work << " of " << most);
    CHECK(most > 0);
    CHECK(std::abs(work) < 0.02 * most);
}

// Layers that lie more than three cells apart at rest are near each other there, each found anew.
TEST_CASE("each point meets what has been pressed thin once, at its side as in its middle") {
    Aggregate thin = make_block(6, 12, 6, 0.1, kSpringy),
              small = make_block(2, 2, 2, 0.02, kSpringy);
    for (std::size_t p = 0; p < thin.particle_count(); ++p) {
        thin.particle_position.y[p] *= 0.02;
    }
    const auto at = [&](double x) {
        place(small, {Quat::Identity(), Vec3(x, -0.012 - 0.02 + 0.001, 0.002)});
        return pressed({&small, &thin});
    };
    const Pressed middle = at(0.02), side = at(0.22);
    REQUIRE(middle.sums[0].contacts > 9);
    CHECK(side.sums[0].contacts == middle.sums[0].contacts);
    CHECK(side.total(0).y() == Approx(middle.total(0).y()).epsilon(1e-3));
}

TEST_CASE("an edge and a corner are met as soon as they touch") {
    Aggregate floor = make_block(8, 2, 8, 0.1, kSpringy), die = make_block(3, 3, 3, 0.1, kSpringy);
    const Quat on_edge(Eigen::AngleAxisd(kPi / 4, Vec3::UnitX()));
    const Quat on_corner = turn_onto(Vec3(-1, -1, -1), Vec3(0, -1, 0));
    for (const auto& [turn, half] :
         {std::pair(on_edge, std::sqrt(2.)), std::pair(on_corner, std::sqrt(3.))}) {
        for (double depth : {-0.001, 0.002}) {
            place(die, {turn, Vec3(0.013, 0.1 + 0.15 * half - depth, 0.021)});
            CHECK((pressed({&floor, &die}).total(1).y() > 0) == (depth > 0));
        }
    }
}

TEST_CASE("force and moment of contact vanish in sum, however the bodies lie and are bent") {
    Aggregate a = make_block(5, 4, 3, 0.1, kSpringy), b = make_block(4, 4, 6, 0.07, kSpringy);
    const Pose turned{Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized())),
                      Vec3(0.05, 0.33, 0.02)};
    place(b, turned);
    for (Aggregate* m : {&a, &b}) {
        for (std::size_t p = 0; p < m->particle_count(); ++p) {
            const Vec3 x = m->particle_position.at(p);
            m->particle_position.add(
                p, 0.01 * Vec3(std::sin(9 * x.y()), std::cos(7 * x.z()), std::sin(5 * x.x())));
            m->particle_velocity.set(p, Vec3(std::sin(31. * double(p)), -1, 0.3));
        }
    }
    const Pressed p = pressed({&a, &b});
    Vec3 moment = Vec3::Zero();
    double size = 0;
    for (std::size_t s = 0; s < 2; ++s) {
        const Aggregate& m = s == 0 ? a : b;
        for (std::size_t n = 0; n < m.particle_count(); ++n) {
            moment += m.particle_position.at(n).cross(p.force[s].at(n));
            size += p.force[s].at(n).norm();
        }
    }
    CHECK(p.sums[0].contacts > 5);
    CHECK(size > 0);
    CHECK((p.total(0) + p.total(1)).norm() < 1e-13 * size);
    CHECK(moment.norm() < 1e-13 * size);
}

TEST_CASE("what slept is looked at again soon after it wakes, however far all else is") {
    Aggregate a = make_block(3, 3, 3, 0.1, kSpringy), b = a, far = a;
    const auto move = [](Aggregate& m, double by) {
        for (double& y : m.particle_position.y) y += by;
    };
    move(b, 0.45);  // one and a half cells above the first
    move(far, 100);
    BodyContact contact({&a, &b, &far}, motion_settings());
    contact.renew({0, 0, 0});
    REQUIRE(contact.candidates() == 0);
    move(far, 1);
    contact.renew({1, 1, 0});
    move(b, -0.18);
    contact.renew({0, 0, 0});
    CHECK(contact.candidates() > 0);
}

TEST_CASE("what lies pressed at the start presses as much after its first step is taken back") {
    Aggregate a = make_block(3, 3, 3, 0.1, kSpringy), b = a;
    place(b, {Quat::Identity(), Vec3(0.29, 0.02, 0.01)});
    BodyContact contact({&a, &b}, motion_settings());
    const std::vector<char> asleep(2, 0);
    const auto push = [&] {
        std::vector<Vec3Array> force(2);
        for (Vec3Array& f : force) f.x = f.y = f.z = std::vector<double>(a.particle_count(), 0.0);
        std::vector<ContactSums> sums;
        contact.renew(asleep);
        contact.add_forces({&force[0], &force[1]}, Vec3::Zero(), 1e-6, asleep, sums);
        return std::pair{sums[0].stored, force[1].x};
    };
    const auto start = contact.save();
    const auto first = push();
    REQUIRE(first.first > 0);
    contact.commit(asleep);
    contact.restore(*start);
    CHECK(push() == first);
}

TEST_CASE("a block slides over another's lattice without rattling", "[stress]") {
    // The lower body's lattice stands along the surface, then obliquely to it.
    for (double turn : {0.0, 0.35}) {
        const Vec3 up(-std::sin(turn), std::cos(turn), 0), along(up.y(), -up.x(), 0);
        const test::Distance slab = [&](const Vec3& x) {
            const Vec3 p(along.dot(x), up.dot(x), x.z());
            return (p.cwiseAbs() - Vec3(0.75, 0.2, 0.45)).maxCoeff();
        };
        Aggregate lower = make_shape(slab, Vec3(-0.9, -0.6, -0.5), Vec3i(18, 12, 10), 0.1);
        lower.material = kSpringy;
        Aggregate upper = make_block(8, 3, 8, 0.08, kSpringy);
        double least = 1e300, most = 0, across = 0;
        for (int n = 0; n < 40; ++n) {
            const double depth = 0.002;
            Pose pose{Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ())), Vec3::Zero()};
            pose.translation = along * (-0.2 + 0.0071 * n) + up * (0.2 + 0.12 - depth);
            place(upper, pose);
            const Vec3 f = pressed({&upper, &lower}).total(0);
            least = std::min(least, up.dot(f));
            most = std::max(most, up.dot(f));
            across = std::max(across, std::abs(along.dot(f)));
        }
        INFO("turn " << turn << ", force " << least << " to " << most << ", across " << across);
        CHECK(least > 0);
        // The oblique body stands for its surface by points of unequal density.
        CHECK(most / least < (turn == 0 ? 1.06 : 1.13));
        CHECK(across < 0.05 * least);
    }
}

TEST_CASE("nothing pushes inside a body, however it is bent") {
    Aggregate strip = make_block(40, 3, 4, 0.05, kSpringy);
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    for (double turn : {0.0, 3.0, 5.5}) {
        deform(strip, [&](const Vec3& x) -> Vec3 {
            if (turn == 0) return x;
            const double radius = 2.0 / turn, angle = x.x() / radius;
            return Vec3((radius - x.y()) * std::sin(angle),
                        radius - (radius - x.y()) * std::cos(angle), x.z());
        });
        const Pressed p = pressed({&strip}, settings);
        CHECK(p.sums[0].contacts == 0);
    }
    // Pressed to a third of its height, its own sides still do not meet.
    deform(strip, [](const Vec3& x) -> Vec3 { return x.cwiseProduct(Vec3(0.3, 0.3, 1)); });
    CHECK(pressed({&strip}, settings).sums[0].contacts == 0);
}
