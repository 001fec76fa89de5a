// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/resting.h"

#include <algorithm>
#include <limits>

namespace swage {

namespace {

constexpr int kLooks = 64;
constexpr double kLies = 0.05;  // spacings beside the nearest point: what lies on a tool, too
constexpr double kPlace = 0.5;  // spacings: the nearest point of what is not far

}  // namespace

Rest rest_on(const Tool& tool, const Pose& world_from_tool, const std::vector<Vec3>& body,
             double spacing) {
    Rest rest;
    rest.friction = tool.friction;
    const Pose tool_from_world = world_from_tool.inverse();
    std::vector<Distance> all;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& p : body) {
        all.push_back(distance_to(tool.shape, tool_from_world * p));
        least = std::min(least, all.back().value);
    }
    for (std::size_t p = 0; p < body.size(); ++p) {
        if (all[p].value > least + kLies * spacing) continue;
        rest.point.push_back(body[p]);
        rest.out.push_back(world_from_tool.turn(all[p].normal));
        rest.normal += rest.out.back();
    }
    if (!(rest.normal.norm() > 0)) return rest;
    rest.normal.normalize();
    rest.is_near = least < kPlace * spacing;
    double top = -std::numeric_limits<double>::infinity(), low = -top;
    for (const Vec3& p : surface_of(tool.shape).position) {
        top = std::max(top, rest.normal.dot(world_from_tool * p));
    }
    for (const Vec3& p : body) low = std::min(low, rest.normal.dot(p));
    rest.is_apart = low > top - kPlace * spacing;
    return rest;
}

Acting acting(const LoadSet& set, const Drive& now, const Aggregate& matter) {
    Acting acts;
    acts.time = now.time;
    const Vec3 centre = matter.centre();
    const std::vector<LoadSum> sums = set.sums(matter, now);
    for (std::size_t n = 0; n < sums.size(); ++n) {
        const bool is_weight = set.has_gravity() && n + 1 == sums.size();
        acts.force += sums[n].force;
        acts.torque += sums[n].torque + (sums[n].centre - centre).cross(sums[n].force);
        if (is_weight) {
            acts.weight = sums[n].force.norm();
        } else {
            acts.loads += sums[n].force;
            acts.size += sums[n].force.norm();
        }
    }
    return acts;
}

std::vector<Drive> looks_at(const StageSpec& stage, const Machine& machine) {
    std::vector<Drive> looks;
    const int count = std::min(stage.frames, kLooks);
    for (int n = 1; n <= count; ++n) {
        const int frame = static_cast<int>(long(stage.frames) * n / count);
        looks.push_back(drive_at(machine, double(frame) / stage.frames, stage.duration));
    }
    return looks;
}

}  // namespace swage
