// SPDX-License-Identifier: GPL-3.0-or-later
// Contact where only one side's surface points lie in the other, and where those of both do: of two
// bodies and of one.
#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/body_contact.h"
#include "tests/catch.h"
#include "tests/shared/cells.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;
const Material kSlippery{.young_modulus = 1e6, .density = 1000, .damping_ratio = 0, .friction = 0};

// Two blocks of 6 x 4 x 6 and 4 x 4 x 4 cells, so many cells apart at rest: of one body, or one
// alone.
Aggregate blocks(bool low, bool high, int gap, const Material& material = kSlippery) {
    return make_cells(Vec3(-0.3, 0, -0.3), Vec3i(6, 8 + gap, 6), kSpacing, material,
                      [&](const Vec3i& at) {
                          if (at.y() < 4) return low;
                          return high && at.y() >= 4 + gap && at.x() > 0 && at.x() < 5 &&
                                 at.z() > 0 && at.z() < 5;
                      });
}

bool is_high(const Aggregate& m, std::size_t p) { return m.particle_reference.at(p).y() > 0.45; }

// Turns what lies above about its middle and puts its lowest corner so deep into the rest.
void put(Aggregate& m, const Quat& turn, const Vec3& along, double depth) {
    double lowest = 0, top = 0;
    for (int c = 0; c < 8; ++c) {
        const Vec3 corner = 0.2 * Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
        lowest = std::min(lowest, (turn * corner).y());
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        top = std::max(top, m.particle_reference.at(p).y());
    }
    const Vec3 to = Vec3(along.x(), 0.4 - lowest - depth, along.z());
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        if (is_high(m, p)) m.particle_position.set(p, to + turn * (x - Vec3(0, top - 0.2, 0)));
    }
}

SimSettings settings_for(std::size_t bodies) {
    SimSettings settings = motion_settings();
    settings.self_contact = bodies == 1;
    return settings;
}

// What lifts the upper one [N].
double lift(const std::vector<Aggregate*>& bodies) {
    BodyContact contact(bodies, settings_for(bodies.size()));
    const std::vector<char> asleep(bodies.size(), 0);
    contact.renew(asleep);
    std::vector<Vec3Array> force(bodies.size());
    std::vector<Vec3Array*> forces;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::vector<double> none(bodies[b]->particle_count(), 0.0);
        force[b].x = force[b].y = force[b].z = none;
        forces.push_back(&force[b]);
    }
    std::vector<ContactSums> sums;
    contact.add_forces(forces, Vec3::Zero(), 1e-10, asleep, sums);
    double up = 0, all = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        for (std::size_t p = 0; p < force[b].size(); ++p) {
            up += is_high(*bodies[b], p) ? force[b].y[p] : 0;
            all += force[b].y[p];
        }
    }
    CHECK(std::abs(all) < 1e-12 * std::abs(up));
    return up;
}

struct Collision {
    double remainder = 0, passed = 0;             // the largest, of the energy at first
    Vec3 up = Vec3::Zero(), down = Vec3::Zero();  // mean velocities at the end [m/s]
    std::uint64_t hash = 0;
};

// A block falls with a corner first on another, which flies along.
Collision collide(bool is_one, double friction, double safety) {
    Material m = kSpringy;
    m.restitution = 0.5;
    m.friction = friction;
    Aggregate low = blocks(true, is_one, 1, m), high = blocks(false, true, 1, m);
    const Quat turn(Eigen::AngleAxisd(0.6, Vec3(1, 0.4, 0.7).normalized()));
    double energy = 0;
    std::vector<Aggregate*> bodies{&low};
    if (!is_one) bodies.push_back(&high);
    for (Aggregate* body : bodies) {
        put(*body, turn, Vec3(0.05, 0, -0.08), -0.02);
        for (std::size_t p = 0; p < body->particle_count(); ++p) {
            body->particle_velocity.set(p, is_high(*body, p) ? Vec3(-0.5, -3, 0.2) : Vec3(0, 1, 0));
        }
        energy += kinetic_energy(*body);
    }
    SimSettings settings = settings_for(bodies.size());
    settings.step_safety = safety;
    const Apparatus nothing;
    Simulation simulation(bodies, nothing, settings);
    Collision result;
    for (int f = 0; f < 30; ++f) {
        const FrameReport r = simulation.advance(still(0.004 * f), still(0.004 * (f + 1)));
        result.remainder = std::max(result.remainder, std::abs(r.remainder) / energy);
    }
    int ups = 0, downs = 0;
    for (const Aggregate* body : bodies) {
        for (std::size_t p = 0; p < body->particle_count(); ++p) {
            const bool up = is_high(*body, p);
            (up ? result.up : result.down) += body->particle_velocity.at(p);
            ++(up ? ups : downs);
        }
    }
    result.up /= ups, result.down /= downs;
    result.hash = state_hash(low);
    return result;
}

}  // namespace

TEST_CASE("parts of one body press on each other as two bodies, by face, by edge and by corner") {
    const Quat level = Quat::Identity(), on_edge(Eigen::AngleAxisd(kPi / 4, Vec3::UnitX())),
               on_corner = turn_onto(Vec3(-1, -1, -1), Vec3(0, -1, 0));
    for (int gap : {1, 6}) {
        Aggregate one = blocks(true, true, gap), low = blocks(true, false, gap),
                  high = blocks(false, true, gap);
        for (const auto& [name, turn] : {std::pair("face", level), std::pair("edge", on_edge),
                                         std::pair("corner", on_corner)}) {
            for (int n = 0; n < 12; ++n) {
                const Vec3 along(0.007 * n - 0.04, 0, 0.011 * n - 0.05);
                put(one, turn, along, 0.002);
                put(high, turn, along, 0.002);
                const double by_itself = lift({&one}), of_two = lift({&low, &high});
                INFO(name << ", " << gap << " cells apart at rest, " << n);
                CHECK(of_two > 0);
                CHECK(by_itself == Approx(of_two).epsilon(0.02));
            }
        }
    }
}

TEST_CASE("what contacts of a body with itself share is the slope of what they hold") {
    // Points of two sides, about faces and corners of boxes, some of both in one, and a particle.
    struct Point {
        OwnWay way;
        double held;
    };
    std::vector<Point> points;
    for (int n = 0; n < 120; ++n) {
        const auto some = [&](int m, double most) { return std::fmod(7.31 * n * m + m, most); };
        points.push_back({{Vec3i(int(some(3, 20)), int(some(5, 20)), 3 + n % 9), n % 20 == 19,
                           Vec3(some(11, 20), 6 + some(13, 4), 4 + some(17, 6))},
                          1 + some(2, 3)});
    }
    OwnShares shares(Vec3i(20, 18, 12));
    const auto held = [&] {
        shares.begin(points.size());
        for (const Point& p : points) {
            const OwnSpot spot = shares.spot_of(p.way);
            if (spot.box == OwnSpot::kMixed) {
                shares.add_mixed(p.way, {.now = p.held});
            } else {
                shares.add(spot, {.now = p.held});
            }
        }
        return shares.find().now;
    };
    double sum = 0;
    const double all = held();
    for (std::size_t n = 0; n < points.size(); ++n) sum += shares.share(n) * points[n].held;
    CHECK(sum == Approx(all));
    int sloping = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
        held();
        const double share = shares.share(n), h = 1e-4;
        const Vec3 slope = shares.slopes(n) ? shares.slope(n) : Vec3(Vec3::Zero());
        const auto rise = [&](double& of) {
            const double was = of;
            of = was + h;
            const double more = held();
            of = was - h;
            const double less = held();
            of = was;
            return (more - less) / (2 * h);
        };
        INFO(n);
        CHECK(rise(points[n].held) == Approx(share).margin(2e-3));
        for (int axis = 0; axis < 3; ++axis) {
            const double by = points[n].held * slope[axis];
            CHECK(rise(points[n].way.place[axis]) == Approx(by).margin(1e-2));
            sloping += std::abs(by) > 0.03;
        }
    }
    CHECK(sloping > 20);
}

TEST_CASE("pieces of one body that meet with a corner part as two bodies do, by the books") {
    for (double friction : {0.0, 0.3}) {
        const Collision one = collide(true, friction, 0.4), two = collide(false, friction, 0.4),
                        fine = collide(true, friction, 0.05);
        INFO("friction " << friction << ": remainders " << one.remainder << ' ' << two.remainder
                         << ' ' << fine.remainder << "; up " << one.up.transpose() << ", two "
                         << two.up.transpose());
        CHECK((one.up - two.up).norm() < 0.02 * (two.up - two.down).norm());
        CHECK(one.remainder < 4e-3);
        CHECK(fine.remainder < 0.25 * one.remainder);
    }
}

TEST_CASE("pieces of one body that meet have the same bits at any thread count") {
    std::vector<std::uint64_t> hash;
    for (int threads : {1, 2, 3}) {
        set_thread_count(threads);
        hash.push_back(collide(true, 0.3, 0.4).hash);
    }
    set_thread_count(0);
    CHECK(hash[0] == hash[1]);
    CHECK(hash[0] == hash[2]);
}
