// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that nothing holds, by explicit steps: slowed by a medium, in collision, and swinging.
#include <cmath>

#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

const Apparatus kNothing;

SimSettings explicit_settings() {
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    return settings;
}

// A cube of 0.1 m that flies along x through a medium, without weight or from rest by its weight.
struct Flight {
    static constexpr double kSide = 0.1, kSpeed = 10, kGravity = 9.81;
    Aggregate cube;
    SimSettings settings = explicit_settings();
    double time = 0, way = 0, speed = 0;  // now

    explicit Flight(int across)
        : cube(block_of(Vec3::Constant(kSide), kSide / across, [] {
              Material material;
              material.young_modulus = 1e6;
              material.density = 1000;
              return material;
          }())) {}
    void start(double v) {
        for (double& x : cube.particle_velocity.x) x = v;
    }
    // Both after further times, each from where the one before ended.
    template <typename Look>
    void fly(const std::vector<double>& times, const Look& look) {
        const double from = cube.centre().x();
        Simulation simulation(cube, kNothing, settings);
        for (double to : times) {
            simulation.advance(at_time(time), at_time(to));
            time = to;
            way = cube.centre().x() - from;
            speed = cube.mean_velocity().x();
            look();
        }
    }
    // Of the medium that gives the drag k v^2 with k / m = rate [1/m]: a quarter of the surface
    // faces the flow in the mean (laws/ambient_drag.h).
    void set_medium(double rate) {
        settings.drag_coefficient = 1;
        settings.medium_density = rate * 1000 * kSide * kSide * kSide / (0.5 * 1.5 * kSide * kSide);
    }
};

void drag(bool brief, Values& values) {
    for (int across : {1, 2, 4}) {
        if (brief && across > 1) break;
        // The step is in proportion to the spacing.
        Flight flight(across);
        constexpr double kRate = 0.5;  // k / m [1/m]
        flight.set_medium(kRate);
        flight.start(Flight::kSpeed);
        flight.fly({0.2, 1.0}, [&] {
            if (flight.time < 1) return;
            const double slowed = 1 + kRate * Flight::kSpeed * flight.time;
            values.add(relative("slowed [m/s]", across, Flight::kSpeed / slowed, flight.speed,
                                3e-3 / across));
            values.add(relative("its way [m]", across, std::log(slowed) / kRate, flight.way,
                                3e-3 / across));
        });
    }
    // A fall whose terminal velocity is 10 m/s.
    constexpr int kAcross = 2;
    constexpr double kTerminal = 10, kG = Flight::kGravity;
    Flight fall(kAcross);
    fall.set_medium(kG / (kTerminal * kTerminal));
    fall.settings.gravity = {kG, 0, 0};
    fall.fly(brief ? std::vector<double>{0.5, 1} : std::vector<double>{0.5, 1, 2, 5}, [&] {
        const double x = kG * fall.time / kTerminal;
        const std::string after = " after " + std::to_string(fall.time).substr(0, 3) + " s ";
        values.add(
            relative("fall" + after + "[m/s]", 0, kTerminal * std::tanh(x), fall.speed, 1e-3));
        values.add(relative("fall" + after + "[m]", 0,
                            kTerminal * kTerminal / kG * std::log(std::cosh(x)), fall.way, 1e-3));
    });
    if (brief) return;
    // Drag in proportion to the speed, on the face that meets the flow.
    Flight facing(kAcross);
    constexpr double kPerSecond = 2;
    facing.settings.directional_drag = kPerSecond * 1000 * Flight::kSide;
    facing.start(Flight::kSpeed);
    facing.fly({1.0}, [&] {
        const double left = std::exp(-kPerSecond * facing.time);
        values.add(
            relative("drag of the face [m/s]", 0, Flight::kSpeed * left, facing.speed, 3e-3));
        values.add(relative("drag of the face [m]", 0, Flight::kSpeed / kPerSecond * (1 - left),
                            facing.way, 3e-3));
    });
}

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    double size = 0, turn = 0;  // sums of their parts' sizes
    double kinetic = 0;
};

Momenta momenta_of(const std::vector<const Aggregate*>& bodies) {
    Momenta sum;
    for (const Aggregate* m : bodies) {
        for (std::size_t p = 0; p < m->particle_count(); ++p) {
            const Vec3 v = m->particle_velocity.at(p), push = m->particle_mass[p] * v;
            const Vec3 moment = m->particle_position.at(p).cross(push);
            sum.linear += push;
            sum.angular += moment;
            sum.size += push.norm();
            sum.turn += moment.norm();
            sum.kinetic += 0.5 * push.dot(v);
        }
    }
    return sum;
}

// Two bodies tumble into each other off their centres, and part.
void momentum(bool brief, Values& values) {
    Material material;
    material.young_modulus = 1e6;
    material.density = 1000;
    material.damping_ratio = 0;
    material.restitution = 0.7;
    Aggregate a = block_of({0.5, 0.2, 0.2}, 0.1, material),
              b = block_of({0.27, 0.27, 0.27}, 0.09, material);
    const Pose turned{Quat(Eigen::AngleAxisd(0.6, Vec3(1, 1, 0.3).normalized())),
                      Vec3(0.15, 0.32, 0.05)};
    for (std::size_t p = 0; p < b.particle_count(); ++p) {
        b.particle_position.set(p, turned * b.particle_position.at(p));
        b.particle_velocity.set(
            p, Vec3(-0.5, -3, 0) +
                   Vec3(3, 0, 1).cross(b.particle_position.at(p) - turned.translation));
    }
    for (std::size_t p = 0; p < a.particle_count(); ++p) {
        a.particle_velocity.set(p, Vec3(0, 2, 0) + Vec3(0, 0, 6).cross(a.particle_position.at(p)));
    }
    const Momenta before = momenta_of({&a, &b});
    const Vec3 apart = b.mean_velocity() - a.mean_velocity();
    Simulation simulation({&a, &b}, kNothing, explicit_settings());
    const long wanted = brief ? 1000 : 10'000;
    constexpr double kFrame = 0.05;
    long steps = 0;
    FrameReport report;
    for (int frame = 0; steps < wanted; ++frame) {
        report = simulation.advance(at_time(kFrame * frame), at_time(kFrame * (frame + 1)));
        steps += report.steps;
    }
    const Momenta after = momenta_of({&a, &b});
    values.add(absolute("linear, over the sum of sizes", 0, 0,
                        (after.linear - before.linear).norm() / before.size, 1e-9));
    values.add(absolute("angular, over the sum of sizes", 0, 0,
                        (after.angular - before.angular).norm() / before.turn, 1e-9));
    values.add(as_share("energy gained, share", 0, 0,
                        std::max(0.0, (report.kinetic + report.elastic) / before.kinetic - 1),
                        1e-3));
    const double parting = apart.normalized().dot(b.mean_velocity() - a.mean_velocity());
    values.add(absolute("they met (1: they part)", 0, 1, parting < 0, 0.5));
}

// A slender bar, free at both ends, swings along its axis: c = sqrt(E / rho), T = 2 L / c.
void vibration(bool brief, Values& values) {
    constexpr double kLength = 0.8, kStrain = 1e-4, kSpeed = 31.622776601683793;
    constexpr double kPeriod = 2 * kLength / kSpeed;
    const int periods = brief ? 50 : 1000;
    for (int along : {8, 16}) {
        if (brief && along > 8) break;
        Material material;
        material.young_modulus = 1e6;
        material.poisson_ratio = 0;  // else it is wider where it is short, and its mass goes there
        material.density = 1000;
        material.damping_ratio = 0;
        const double spacing = kLength / along;
        Aggregate bar = block_of({kLength, spacing, spacing}, spacing, material);
        const auto shape = [](double x) { return std::sin(kPi * x / kLength); };
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            bar.particle_velocity.set(
                p, {kStrain * kSpeed * shape(bar.particle_reference.at(p).x()), 0, 0});
        }
        Simulation simulation(bar, kNothing, explicit_settings());
        FrameReport report;
        double energy = 0, drift = 0, turns = 0, last = 0;
        for (int n = 1; n <= periods; ++n) {
            report = simulation.advance(at_time((n - 1) * kPeriod), at_time(n * kPeriod));
            const double held = report.kinetic + report.elastic;
            if (n == 1) energy = held;
            drift = std::max(drift, std::abs(held / energy - 1));
            // How far it is on its way round in the plane of place and speed.
            double place = 0, speed = 0;
            for (std::size_t p = 0; p < bar.particle_count(); ++p) {
                const double s = bar.particle_mass[p] * shape(bar.particle_reference.at(p).x());
                place += s * (bar.particle_position.x[p] - bar.particle_reference.at(p).x());
                speed += s * bar.particle_velocity.x[p];
            }
            const double now = std::atan2(2 * kPi / kPeriod * place, speed) / (2 * kPi);
            turns += 1 + std::remainder(now - last, 1);
            last = now;
        }
        values.add(relative("period, mean [ms]", along, 1e3 * kPeriod,
                            1e3 * kPeriod * periods / turns, 0.64 / (along * along)));
        values.add(as_share("most that the energy is off, share", 0, 0, drift, 1e-3));
        values.add(as_share("energy that the books do not explain, share", 0, 0,
                            std::abs(report.remainder) / energy, 1e-3));
    }
}

}  // namespace

void add_flight_cases(std::vector<Case>& cases) {
    cases.push_back({"drag", "a cube slowed by a medium, and its fall to its terminal velocity",
                     "integrals", 0.9, true, drag});
    cases.push_back({"momentum", "two tumbling bodies collide: what 10,000 steps keep", "exact", 0,
                     true, momentum});
    cases.push_back({"vibration", "a free bar swings along its axis 1000 times", "wave equation", 0,
                     true, vibration});
}

}  // namespace swage
