// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/frame_changes.h"

namespace swage {

std::vector<Eigen::Vector4f> steady_turns(const std::vector<Pose>& of_frame) {
    std::vector<Eigen::Vector4f> turn;
    for (const Pose& pose : of_frame) {
        const Eigen::Vector4f now = pose.rotation.normalized().coeffs().cast<float>();
        const bool is_turned = !turn.empty() && turn.back().dot(now) < 0;
        turn.push_back(is_turned ? Eigen::Vector4f(-now) : now);
    }
    return turn;
}

}  // namespace swage
