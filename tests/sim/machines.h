// SPDX-License-Identifier: GPL-3.0-or-later
// Small machines for tests of the simulation: a press; a bender and a twister around a bar along x.
#pragma once

#include "matter/drive.h"
#include "sim/advance.h"
#include "tests/shared/block.h"

namespace swage::test {

struct Bender {
    double height, radius, overhang, pusher, angle, friction;

    Apparatus apparatus() const {
        Apparatus a;
        a.name = "bend";
        const double length = 3 * height;
        a.tool.push_back({"support", CylinderShape{radius, length}, friction});
        a.tool.push_back({"left", CylinderShape{pusher, length}, friction});
        a.tool.push_back({"right", CylinderShape{pusher, length}, friction});
        return a;
    }
    // t from 0 to 1: pressed until 0.6, released until 0.8, lifted clear until 1.
    Drive drive_at(double t) const {
        const double press = t < 0.6 ? t / 0.6 : t < 0.8 ? 1 - (t - 0.6) / 0.2 : 0;
        const double lift = t < 0.8 ? 0 : (t - 0.8) / 0.2 * 2 * height;
        const Vec3 centre(0, -height / 2 - radius, 0);
        Drive d;
        d.time = t;
        d.world_from_tool.push_back({Quat::Identity(), centre - Vec3(0, lift, 0)});
        for (int side : {-1, 1}) {
            const Quat turn(Eigen::AngleAxisd(-side * press * angle / 2, Vec3::UnitZ()));
            const Vec3 arm(side * overhang, height + radius + pusher, 0);
            d.world_from_tool.push_back({turn, centre + turn * arm + Vec3(0, lift, 0)});
        }
        return d;
    }
};

// Two plates about a block with this side, of which the upper one comes down.
struct Press {
    double side;

    Apparatus apparatus() const {
        Apparatus a;
        a.name = "press";
        for (const char* name : {"anvil", "plate"}) {
            a.tool.push_back({name, BoxShape{Vec3(3 * side, side, 3 * side), side / 20}, 0.1});
        }
        return a;
    }
    // `down`: share of the side.
    Drive drive_at(double time, double down) const {
        Drive d;
        d.time = time;
        d.world_from_tool.push_back({Quat::Identity(), Vec3(0, -side, 0)});
        d.world_from_tool.push_back({Quat::Identity(), Vec3(0, side * (1 - down), 0)});
        return d;
    }
};

// Grips at both ends of a bar along x; the right one turns.
struct Twister {
    Apparatus apparatus;
    std::vector<Pose> start;

    Twister(const Aggregate& bar, double half_length, double grip) {
        apparatus.name = "twist";
        for (int side : {-1, 1}) {
            Grip g;
            g.name = side < 0 ? "hold" : "turn";
            g.point =
                points_where(bar, [&](const Vec3& x) { return side * x.x() > half_length - grip; });
            const Pose pose{Quat::Identity(), Vec3(side * half_length, 0, 0)};
            for (int p : g.point) g.anchor.push_back(pose.inverse() * bar.surface_position(p));
            apparatus.grip.push_back(g);
            start.push_back(pose);
        }
    }
    Drive drive_at(double t, double angle) const {
        Drive d;
        d.time = t;
        d.world_from_grip = start;
        d.world_from_grip[1].rotation = Quat(Eigen::AngleAxisd(t * angle, Vec3::UnitX()));
        return d;
    }
};

// Angle [rad] between the end sections of a bar along x, turned about z.
inline double bend_angle(const Aggregate& m) {
    double high = 0;
    for (double x : m.particle_reference.all().x) high = std::max(high, x);
    const auto section_turn = [&](double end) {
        Vec3 outer = Vec3::Zero(), inner = Vec3::Zero();
        const double a = m.lattice.spacing;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const double x = m.particle_reference.at(p).x();
            if (std::abs(x - end) < 1e-6 * a) outer += m.particle_position.at(p);
            if (std::abs(x - end + std::copysign(a, end)) < 1e-6 * a) {
                inner += m.particle_position.at(p);
            }
        }
        const Vec3 way = std::copysign(1.0, end) * (outer - inner);
        return std::atan2(way.y(), way.x());
    };
    return section_turn(-high) - section_turn(high);
}

}  // namespace swage::test
