// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_time.h"

namespace swage {

void write_usd_poses(UsdText& out, int first, const std::vector<Pose>& of_frame) {
    std::vector<Vec3> place;
    for (const Pose& pose : of_frame) place.push_back(pose.translation);
    const std::vector<Eigen::Vector4f> turn = steady_turns(of_frame);
    const auto at = [&](int frame) { return static_cast<std::size_t>(frame - first); };
    out.value("quatf xformOp:orient", "", changes(turn, first, Between::straight),
              [&](int frame) {  // w first there
                  const Eigen::Vector4f& q = turn[at(frame)];
                  out.vector<4>(Eigen::Vector4f(q[3], q[0], q[1], q[2]));
              });
    out.value("double3 xformOp:translate", "", changes(place, first, Between::straight),
              [&](int frame) { out.place(place[at(frame)]); });
    out.line("uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]");
}

}  // namespace swage
