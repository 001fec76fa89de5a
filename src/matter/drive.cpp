// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/drive.h"

#include <utility>

namespace swage {

namespace {
std::vector<Pose> poses_between(const std::vector<Pose>& from, const std::vector<Pose>& to,
                                double s) {
    std::vector<Pose> poses;
    poses.reserve(from.size());
    for (std::size_t n = 0; n < from.size(); ++n) poses.push_back(between(from[n], to[n], s));
    return poses;
}
}  // namespace

Drive drive_between(const Drive& from, const Drive& to, double s) {
    std::vector<double> strength;
    for (std::size_t n = 0; n < from.load_strength.size(); ++n) {
        strength.push_back((1 - s) * from.load_strength[n] + s * to.load_strength[n]);
    }
    return {(1 - s) * from.time + s * to.time,
            poses_between(from.world_from_tool, to.world_from_tool, s),
            poses_between(from.world_from_grip, to.world_from_grip, s),
            poses_between(from.world_from_blade, to.world_from_blade, s),
            std::move(strength),
            (1 - s) * from.gravity_strength + s * to.gravity_strength};
}

}  // namespace swage
