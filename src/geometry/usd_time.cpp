// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_time.h"

namespace swage {

void write_usd_poses(UsdText& out, int first, const std::vector<Pose>& of_frame) {
    std::vector<Vec3> place;
    std::vector<Eigen::Vector4f> turn;  // w first, as USD has it
    for (const Pose& pose : of_frame) {
        place.push_back(pose.translation);
        const Quat q = pose.rotation.normalized();
        const Eigen::Vector4f now =
            Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).cast<float>().eval();
        // Between two samples a reader takes the shorter way, of signs that differ not all do.
        const bool is_turned = !turn.empty() && turn.back().dot(now) < 0;
        turn.push_back(is_turned ? Eigen::Vector4f(-now) : now);
    }
    const auto at = [&](int frame) { return static_cast<std::size_t>(frame - first); };
    out.value("quatf xformOp:orient", "", changes(turn, first, Between::straight),
              [&](int frame) { out.vector<4>(turn[at(frame)]); });
    out.value("double3 xformOp:translate", "", changes(place, first, Between::straight),
              [&](int frame) { out.place(place[at(frame)]); });
    out.line("uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]");
}

}  // namespace swage
