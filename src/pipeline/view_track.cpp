// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/view_track.h"

#include <algorithm>
#include <limits>

namespace swage {

namespace {

constexpr double kBefore = 0.1, kBehind = 10;  // [nearest, box]

}  // namespace

ViewTrack view_track(const Shot& shot, int count, const FrameRange& frames, const Box& seen,
                     const Box& all) {
    const CameraPath camera = shot.camera();
    const Pose world_from_drawn = {shot.drawn_from_world.conjugate(), Vec3::Zero()};
    ViewTrack track{{}, std::numeric_limits<double>::infinity(), 0, lens_of(shot.settings)};
    for (int frame = frames.first; frame <= frames.last; ++frame) {
        const View drawn = camera.at(still_share(shot.settings.camera, frame - 1, count));
        track.pose.push_back(world_from_drawn * Pose{Quat(drawn.world_from_view), drawn.eye});
        const Pose& pose = track.pose.back();
        const View view{pose.translation, pose.rotation.toRotationMatrix()};
        track.near = std::min(track.near, depth_range(seen, view).near);
        track.far = std::max(track.far, depth_range(all, view).far);
    }
    track.near *= kBefore;
    track.far += kBehind * seen.size().norm();
    return track;
}

}  // namespace swage
