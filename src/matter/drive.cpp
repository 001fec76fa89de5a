// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/drive.h"

#include <utility>

namespace swage {

namespace {

using Ways = std::vector<std::optional<WayEnds>>;

std::vector<Pose> poses_between(const std::vector<Pose>& from, const std::vector<Pose>& to,
                                const Ways& way, double s) {
    std::vector<Pose> poses;
    poses.reserve(from.size());
    for (std::size_t n = 0; n < from.size(); ++n) {
        const bool bends = n < way.size() && way[n];
        poses.push_back(bends ? between(from[n], to[n], *way[n], s) : between(from[n], to[n], s));
    }
    return poses;
}

}  // namespace

Pose between(const Pose& from, const Pose& to, const WayEnds& ends, double s) {
    const double rest = 1 - s;
    return twisted(from, s * s * (3 - 2 * s) * twist_between(from, to) +
                             s * rest * rest * ends.leaving - s * s * rest * ends.coming);
}

Drive drive_between(const Drive& from, const Drive& to, double s) {
    std::vector<double> strength;
    for (std::size_t n = 0; n < from.load_strength.size(); ++n) {
        strength.push_back((1 - s) * from.load_strength[n] + s * to.load_strength[n]);
    }
    return {(1 - s) * from.time + s * to.time,
            poses_between(from.world_from_tool, to.world_from_tool, to.tool_way, s),
            poses_between(from.world_from_grip, to.world_from_grip, to.grip_way, s),
            poses_between(from.world_from_blade, to.world_from_blade, {}, s),
            std::move(strength),
            (1 - s) * from.gravity_strength + s * to.gravity_strength};
}

}  // namespace swage
