// SPDX-License-Identifier: GPL-3.0-or-later
// A body along x between a grip that holds one end and one that pulls the other.
#pragma once

#include <memory>

#include "tests/sim/motion.h"

namespace swage::test {

// Surface points beyond |x| = `from` [m] are held as they lie.
inline std::vector<Grip> end_grips(const Aggregate& matter, double from) {
    std::vector<Grip> grips;
    for (int side : {-1, 1}) {
        Grip grip;
        grip.name = side < 0 ? "hold" : "pull";
        grip.point = points_where(matter, [&](const Vec3& x) { return side * x.x() > from; });
        for (int p : grip.point) grip.anchor.push_back(matter.surface_position(p));
        grips.push_back(grip);
    }
    return grips;
}

struct PulledBar {
    Aggregate matter;
    Apparatus apparatus;
    SimSettings settings;
    std::unique_ptr<Simulation> simulation;
    Drive drive;

    PulledBar(Aggregate body, double length, double tolerance) : matter(std::move(body)) {
        apparatus.name = "pull";
        apparatus.grip = end_grips(matter, 0.4999 * length);
        drive.world_from_grip = {Pose{}, Pose{}};
        settings.tolerance = tolerance;
        settings.grip_stiffness = 100;
        start();
    }
    // With the matter and settings as they are now.
    void start() { simulation = std::make_unique<Simulation>(matter, apparatus, settings); }
    FrameReport pull_to(double way, double duration = 1) {
        Drive to = drive;
        to.time += duration;
        to.world_from_grip[1].translation.x() = way;
        const FrameReport r = simulation->advance(drive, to);
        drive = to;
        return r;
    }
};

inline double pull(const FrameReport& r) { return r.load[1].force.x(); }

}  // namespace swage::test
