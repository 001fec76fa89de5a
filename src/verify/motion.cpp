// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies in motion, by explicit steps.
#include <array>
#include <cmath>

#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kGravity = 9.81;  // [m/s2]

// A body that nothing but the apparatus, gravity and itself acts on.
struct Free {
    Aggregate matter;
    Apparatus apparatus{};
    SimSettings settings{};
    Drive drive{};

    explicit Free(Aggregate body) : matter(std::move(body)) {
        settings.solver = Solver::explicit_steps;
    }
    // A thick plate whose upper side goes through the origin and looks along y.
    void add_plate(double size, double friction) {
        apparatus.tool.push_back({"plate", BoxShape{{size, 0.2 * size, size}, 0}, friction});
        drive.world_from_tool.push_back({Quat::Identity(), {0, -0.1 * size, 0}});
    }
    void move_by(const Vec3& way) {
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            matter.particle_position.add(p, way);
        }
    }
};

// A cube of 0.1 m that stands on the plate.
Free cube_on_plate(double friction, const Vec3& gravity) {
    constexpr double kSide = 0.1;
    Material material;
    material.young_modulus = 1e6;
    material.density = 1000;
    material.damping_ratio = 0.3;
    Free cube(block_of(Vec3::Constant(kSide), kSide / 3, material));
    cube.settings.gravity = gravity;
    cube.add_plate(100 * kSide, friction);
    cube.move_by({0, 0.5 * kSide, 0});
    return cube;
}

// What the cube does on a slope is what it does on the level where gravity leans. Gravity comes on
// evenly in the first kRise seconds, so that nothing bounces; from its start, and from then.
constexpr double kRise = 0.5;  // [s]
struct Slid {
    double way, later;  // [m]
};
Slid slide_on_slope(double degrees, double friction, double seconds) {
    const double slope = degrees * kPi / 180;
    Free cube = cube_on_plate(friction, kGravity * Vec3(std::sin(slope), -std::cos(slope), 0));
    const double start = cube.matter.centre().x();
    Simulation simulation(cube.matter, cube.apparatus, cube.settings);
    Drive light = cube.drive, full = cube.drive, end = cube.drive;
    light.gravity_strength = 0;
    full.time = kRise;
    end.time = kRise + seconds;
    simulation.advance(light, full);
    const double risen = cube.matter.centre().x();
    simulation.advance(full, end);
    return {cube.matter.centre().x() - start, cube.matter.centre().x() - risen};
}

void incline(bool brief, Values& values) {
    constexpr int kAcross = 3;
    const double sine = 0.5, cosine = std::sqrt(0.75);
    constexpr double kSeconds = 1;
    const auto way = [&](double friction) {
        return kGravity * (sine - friction * cosine) *
               (kRise * kRise / 6 + kRise * kSeconds / 2 + kSeconds * kSeconds / 2);
    };
    values.add(relative("way, friction .5 [m]", kAcross, way(0.5),
                        slide_on_slope(30, 0.5, kSeconds).way, 0.01));
    if (brief) return;
    values.add(relative("way, friction .1 [m]", kAcross, way(0.1),
                        slide_on_slope(30, 0.1, kSeconds).way, 0.01));
    values.add(relative("way, friction .57 [m]", kAcross, way(0.57),
                        slide_on_slope(30, 0.57, kSeconds).way, 0.05));
    values.add(absolute("creep in 10 s, friction .58 [m]", kAcross, 0,
                        slide_on_slope(30, 0.58, 10).later, 1e-4));
}

void slide_to_rest(bool, Values& values) {
    constexpr int kAcross = 3;
    constexpr double kSpeed = 2, kFriction = 0.3, kSlowing = kFriction * kGravity;
    Free cube = cube_on_plate(kFriction, {0, -kGravity, 0});
    Drive at = cube.drive, heavy = cube.drive;
    at.gravity_strength = 0;
    heavy.time = kRise;
    Simulation(cube.matter, cube.apparatus, cube.settings).advance(at, heavy);
    for (std::size_t p = 0; p < cube.matter.particle_count(); ++p) {
        cube.matter.particle_velocity.set(p, {kSpeed, 0, 0});
    }
    const double start = cube.matter.centre().x();
    Simulation simulation(cube.matter, cube.apparatus, cube.settings);
    at = cube.drive;
    const auto go_to = [&](double time) {
        Drive to = cube.drive;
        to.time = time;
        simulation.advance(at, to);
        at = to;
        return cube.matter.centre().x() - start;
    };
    const double stop = kSpeed / kSlowing;
    values.add(relative("way after half the time [m]", kAcross, 0.375 * kSpeed * stop,
                        go_to(0.5 * stop), 0.01));
    values.add(relative("way at rest [m]", kAcross, 0.5 * kSpeed * stop, go_to(1.5 * stop), 0.01));
}

// Swings of a bar held at one end that begins with the speeds of one mode: the time of a whole
// number of them, from where the mode's share crosses zero.
double mode_frequency(int across, int mode, int swings) {
    constexpr double kLength = 0.2, kSide = 0.02, kModulus = 1e7, kDensity = 1000;
    // Of a clamped and free end.
    constexpr std::array<double, 2> kRoot = {1.8751040687, 4.6940911330};
    Material material;
    material.young_modulus = kModulus;
    material.poisson_ratio = 0.3;
    material.density = kDensity;
    material.damping_ratio = 0;
    Free bar(block_of({kLength, kSide, kSide}, kSide / across, material));
    Grip clamp;
    clamp.name = "clamp";
    clamp.point = end_face(bar.matter, -Vec3::UnitX());
    for (int p : clamp.point) {
        clamp.anchor.push_back(bar.matter.surface_reference(p));
    }
    bar.apparatus.grip.push_back(clamp);
    bar.drive.world_from_grip.push_back(Pose{});
    const double k = kRoot[mode] / kLength, reach = kRoot[mode];
    const double ratio =
        (std::cosh(reach) + std::cos(reach)) / (std::sinh(reach) + std::sin(reach));
    const auto shape = [&](double x) {
        const double s = k * (x + 0.5 * kLength);
        return std::cosh(s) - std::cos(s) - ratio * (std::sinh(s) - std::sin(s));
    };
    constexpr double kSpeed = 1e-3;  // [m/s], small
    Aggregate& m = bar.matter;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, {0, kSpeed * shape(m.particle_reference.at(p).x()), 0});
    }
    const auto share = [&] {
        double sum = 0;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            sum += m.particle_mass[p] * shape(m.particle_reference.at(p).x()) *
                   (m.particle_position.y[p] - m.particle_reference.at(p).y());
        }
        return sum;
    };
    const double expected = reach * reach / (2 * kPi * kLength * kLength) *
                            std::sqrt(kModulus * kSide * kSide / (12 * kDensity));
    bar.settings.step_safety = 0.3;  // a grip may be as stiff as the step allows, and should be
    Simulation simulation(m, bar.apparatus, bar.settings);
    Drive at = bar.drive;
    const double slice = 1 / (expected * 40);
    double before = 0, first = 0, last = 0;
    for (int n = 1, crossings = 0; crossings <= 2 * swings; ++n) {
        if (n > 40 * 2 * (swings + 1)) return 0;  // it does not swing
        Drive to = bar.drive;
        to.time = n * slice;
        simulation.advance(at, to);
        at = to;
        const double now = share();
        if (n > 1 && (before < 0) != (now < 0)) {
            last = (n - 1 + before / (before - now)) * slice;
            if (crossings++ == 0) first = last;
        }
        before = now;
    }
    return swings / (last - first);
}

void bending_swings(bool brief, Values& values) {
    for (int across : {4, 8}) {
        if (brief && across > 4) break;
        const double bound = across == 8 ? 0.01 : std::numeric_limits<double>::infinity();
        values.add(relative("first [Hz]", across, 8.0552, mode_frequency(across, 0, 1), bound));
        if (brief) break;
        values.add(relative("second [Hz]", across, 48.310, mode_frequency(across, 1, 3), bound));
    }
}

}  // namespace

void add_motion_cases(std::vector<Case>& cases) {
    cases.push_back({"incline", "a cube on a slope of 30 degrees: what slides, and how fast",
                     "Coulomb", 0, true, incline});
    cases.push_back({"slide", "a cube slides until friction has stopped it", "Coulomb", 0, true,
                     slide_to_rest});
    cases.push_back({"swings", "bending frequencies of a bar held at one end", "CalculiX C3D20R", 0,
                     false, bending_swings});
}

}  // namespace swage
