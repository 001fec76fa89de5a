// SPDX-License-Identifier: GPL-3.0-or-later
// What a work-piece lies on, and what acts on it, as it is at the start and at frames.
#pragma once

#include <vector>

#include "machines/machine.h"
#include "matter/aggregate.h"
#include "scene/spec.h"
#include "sim/load_set.h"

namespace swage {

// A tool as the body lies on it.
struct Rest {
    Vec3 normal = Vec3::Zero();  // of the tool, on the whole
    double friction = 0;
    bool is_apart = false;  // a plane across the normal parts it from the body
    bool is_near = false;
    std::vector<Vec3> point, out;  // contacts
};
// `body`: its touching_points().
Rest rest_on(const Tool& tool, const Pose& world_from_tool, const std::vector<Vec3>& body,
             double spacing);

// What acts on the body at one time: on the whole, about its centre.
struct Acting {
    double time = 0;  // [s]
    double weight = 0;
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  // of all
    Vec3 loads = Vec3::Zero();
    double size = 0;  // of loads, one by one [N]
};
Acting acting(const LoadSet& set, const Drive& now, const Aggregate& matter);

// At frames, of which the last is one; so many that little is missed.
std::vector<Drive> looks_at(const StageSpec& stage, const Machine& machine);

}  // namespace swage
