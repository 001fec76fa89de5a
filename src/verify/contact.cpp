// SPDX-License-Identifier: GPL-3.0-or-later
// A ball on a rigid plane: dropped, and pressed.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kGravity = 9.81;  // [m/s2]

Aggregate ball(double diameter, int across, const Material& material) {
    MoldSettings settings;
    settings.spacing = diameter / across;
    return mold(make_shape("sphere", {{"diameter", diameter}, {"division", 3.0 * across}}).mesh,
                material, settings);
}

double lowest(const Aggregate& matter) {
    double low = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        low = std::min(low, matter.surface_position(p).y());
    }
    return low;
}

double height(const Aggregate& matter) { return matter.centre().y(); }

// Of hard matter on a contact a hundred times softer than usual, so that what the ball stores
// inside is little beside what the contact does. NOTE: what it does store comes back in part, and
// its points that touch late meet the floor at less than the ball's speed and lose more: 0.494 to
// 0.51 of the speed are left for softer and harder contacts, where 0.5 is asked.
void ball_drop(bool brief, Values& values) {
    constexpr double kDrop = 1, kShare = 0.5, kSlice = 5e-4;
    for (int across : {4, 5}) {
        if (brief && across > 4) break;
        Material material;
        material.young_modulus = 8e8;
        material.density = 1000;
        material.damping_ratio = 0.1;
        material.restitution = kShare;
        Aggregate body = ball(0.04, across, material);
        const double lift = kDrop - lowest(body);
        for (double& y : body.particle_position.y) y += lift;
        Apparatus apparatus;
        apparatus.name = "floor";
        apparatus.tool.push_back({"floor", BoxShape{{1, 1, 1}, 0}, 0.3});
        SimSettings settings;
        settings.solver = Solver::explicit_steps;
        settings.gravity = {0, -kGravity, 0};
        settings.contact_stiffness = 0.015 / across;  // of one stiffness at any resolution
        const std::vector<Pose> floor{{Quat::Identity(), {0, -0.5, 0}}};
        Simulation simulation(body, apparatus, settings);
        const double start = height(body), given = body.mass() * kGravity * kDrop;
        std::vector<double> impact, apex;
        double rest = 0, gained = 0;
        bool touched = false;
        for (int n = 0; n < 3200; ++n) {
            const FrameReport r =
                simulation.advance(at_time(n * kSlice, floor), at_time((n + 1) * kSlice, floor));
            const bool touches = r.load[0].contacts > 0;
            if (touches && !touched) impact.push_back((n + 0.5) * kSlice);
            if (!touches && touched) {
                rest = (n + 0.5) * kSlice;
                apex.push_back(0);
            }
            if (!apex.empty()) apex.back() = std::max(apex.back(), height(body) - start + kDrop);
            gained = std::max(gained, r.kinetic + r.elastic + r.contact - r.gravity_work);
            touched = touches;
        }
        if (impact.size() < 3 || apex.size() < 2) {
            values.add(absolute("bounces", across, 3, static_cast<double>(impact.size()), 0));
            continue;
        }
        const double first = std::sqrt(2 * kDrop / kGravity);
        values.add(relative("first impact [s]", across, first, impact[0], 0.005));
        values.add(relative("second impact [s]", across, 2 * first, impact[1], 0.01));
        values.add(relative("third impact [s]", across, 2.5 * first, impact[2], 0.01));
        values.add(relative("first return [m]", across, 0.25 * kDrop, apex[0], 0.03));
        values.add(relative("second return [m]", across, 0.0625 * kDrop, apex[1], 0.03));
        values.add(relative("rest [s]", across, 3 * first, rest, 0.01));
        if (across == 4) {
            values.add(as_share("energy gained, share", across, 0, gained / given, 1e-3));
        }
    }
}

// How far a rigid plane comes to a point a depth z below where it touches, and with what force: of
// Hertz's pressure on a circle of radius c of a half-space, by Boussinesq's point loads.
struct Pressed {
    double way, force;
};
Pressed hertz_pressed(double c, double z, double radius, double modulus, double poisson) {
    const double reduced = modulus / (1 - poisson * poisson);
    const double force = 4.0 / 3 * reduced * c * c * c / radius, most = 1.5 * force / (kPi * c * c);
    constexpr int kRings = 200;
    double sunk = 0;
    for (int n = 0; n < kRings; ++n) {
        const double r = (n + 0.5) * c / kRings, far = std::hypot(r, z);
        const double push = most * std::sqrt(1 - r * r / (c * c)) * 2 * kPi * r * c / kRings;
        sunk += push * (1 + poisson) / (2 * kPi * modulus) *
                (z * z / (far * far * far) + 2 * (1 - poisson) / far);
    }
    return {c * c / radius - sunk, force};
}

// Pressed between two plates, its upper half as by one. How far the plate has come to the matter a
// depth below, half a radius, says how wide Hertz's circle is: nearer than that the circle counts
// as no point yet, farther off the ball is no half-space. (Taken to the centre by a half-space's
// way to infinity, as tables have it, the force would be 12 % too high.)
void hertz(bool brief, Values& values) {
    constexpr double kDiameter = 0.1, kRadius = 0.5 * kDiameter, kModulus = 1e6, kPoisson = 0.3;
    for (int across : {24, 32}) {
        if (brief && across > 24) break;
        Material material;
        material.young_modulus = kModulus;
        material.poisson_ratio = kPoisson;
        Aggregate body = ball(kDiameter, across, material);
        const double low = lowest(body), spacing = kDiameter / across;
        Apparatus apparatus;
        apparatus.name = "plates";
        for (const char* name : {"lower", "upper"}) {
            apparatus.tool.push_back({name, BoxShape{Vec3::Constant(2 * kDiameter), 0}, 0});
        }
        SimSettings settings;
        settings.contact_stiffness = 20;  // gives way by 1 to 3 % of what the ball does
        settings.tolerance = 1e-3;
        const auto pressed = [&](double way) {
            Drive drive;
            drive.time = way;
            for (int side : {-1, 1}) {
                drive.world_from_tool.push_back(
                    {Quat::Identity(), {0, side * (kDiameter - low - way), 0}});
            }
            return drive;
        };
        std::vector<ParticleId> below;
        double depth = 0;
        for (std::size_t p = 0; p < body.particle_count(); ++p) {
            const Vec3 x = body.particle_reference.at(p);
            if (std::hypot(x.x(), x.z()) > 0.8 * spacing) continue;
            if (std::abs(x.y() + 0.5 * kRadius) > 0.6 * spacing) continue;
            below.push_back(static_cast<ParticleId>(p));
            depth += x.y() + kRadius;
        }
        depth /= static_cast<double>(below.size());
        Simulation simulation(body, apparatus, settings);
        std::vector<double> force, approach;
        double from = 0;
        for (double share : {0.02, 0.03, 0.04}) {
            const double way = share * kRadius;
            const FrameReport r = simulation.advance(pressed(from), pressed(way));
            from = way;
            double come = way;
            for (ParticleId p : below) {
                come -= (body.particle_position.y[p] - body.particle_reference.at(p).y()) /
                        static_cast<double>(below.size());
            }
            double narrow = 0, wide = kRadius;
            for (int n = 0; n < 60; ++n) {
                const double c = 0.5 * (narrow + wide);
                const bool more = hertz_pressed(c, depth, kRadius, kModulus, kPoisson).way < come;
                (more ? narrow : wide) = c;
            }
            force.push_back(r.load[0].force.y());
            approach.push_back(narrow * narrow / kRadius);
            values.add(relative(fmt::format("force at {:g} R [N]", share), across,
                                hertz_pressed(narrow, depth, kRadius, kModulus, kPoisson).force,
                                force.back(), 0.1));
        }
        values.add(relative(
            "exponent", across, 1.5,
            std::log(force.back() / force.front()) / std::log(approach.back() / approach.front()),
            0.05));
    }
}

}  // namespace

void add_contact_cases(std::vector<Case>& cases) {
    cases.push_back({"ball-drop", "a ball dropped onto a floor bounces until it rests", "h e^2k", 0,
                     false, ball_drop});
    cases.push_back({"hertz", "a ball pressed between rigid plates", "Hertz 1882", 0, true, hertz});
}

}  // namespace swage
