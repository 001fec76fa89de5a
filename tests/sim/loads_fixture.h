// SPDX-License-Identifier: GPL-3.0-or-later
// For tests of what pushes a body without being one.
#pragma once

#include "base/error.h"
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/pulled_bar.h"

namespace swage::test {

inline const Material kSoft{
    .young_modulus = 1e6, .poisson_ratio = 0.3, .density = 1000, .damping_ratio = 0.2};

inline Load pressure_on(const Aggregate& matter, double pressure) {
    Load load;
    load.name = "pressure";
    load.point = points_where(matter, [](const Vec3&) { return true; });
    load.pressure = pressure;
    load.closed = true;
    return load;
}

inline Load force_on(const Aggregate& matter, std::vector<int> points, const Vec3& force) {
    Load load;
    load.name = "push";
    double area = 0;
    for (int p : points) area += matter.surface.area(p);
    for (int p : points) load.force.push_back(matter.surface.area(p) / area * force);
    load.point = std::move(points);
    return load;
}

inline Grip hold(const Aggregate& matter, std::vector<int> points,
                 const Vec3& axes = Vec3::Ones()) {
    Grip grip;
    grip.name = "hold";
    for (int p : points) grip.anchor.push_back(matter.surface_position(p));
    grip.point = std::move(points);
    grip.hold = axes;
    return grip;
}

inline Drive drive_of(const Apparatus& apparatus, double time, double strength) {
    Drive d;
    d.time = time;
    d.world_from_grip.assign(apparatus.grip.size(), Pose{});
    d.load_strength.assign(apparatus.load.size(), strength);
    d.gravity_strength = strength;
    return d;
}

// Goes from nothing to full strength in so many frames.
inline FrameReport put_on(Aggregate& matter, const Apparatus& apparatus,
                          const SimSettings& settings, int frames) {
    Simulation simulation(matter, apparatus, settings);
    FrameReport report;
    for (int f = 1; f <= frames; ++f) {
        report = simulation.advance(drive_of(apparatus, f - 1, double(f - 1) / frames),
                                    drive_of(apparatus, f, double(f) / frames));
    }
    return report;
}

// The message that it stops with; empty: it does not.
inline std::string stopped_by(Aggregate& matter, const Apparatus& apparatus,
                              const SimSettings& settings, int frames) {
    try {
        put_on(matter, apparatus, settings, frames);
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::stopped);
        return error.what();
    }
    return {};
}

inline const Vec3 kBent(0.3, -0.2, 0.1);
inline Vec3 crooked(const Vec3& x) {
    return Eigen::AngleAxisd(x.x() + 0.4, kBent.normalized()) * Vec3(1.2 * x.x(), x.y(), x.z()) +
           x.squaredNorm() * kBent;
}

}  // namespace swage::test
