// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/motion_recorder.h"

namespace swage {

std::vector<Pose> body_poses(const Drive& drive) {
    std::vector<Pose> poses = drive.world_from_tool;
    poses.insert(poses.end(), drive.world_from_grip.begin(), drive.world_from_grip.end());
    poses.insert(poses.end(), drive.world_from_blade.begin(), drive.world_from_blade.end());
    return poses;
}

void MotionRecorder::set_machine(const Apparatus& apparatus) {
    std::vector<DrawnBody> bodies;
    for (const Tool& tool : apparatus.tool) {
        bodies.push_back({tool.name, surface_of(tool.shape), tool.color});
    }
    for (const Grip& grip : apparatus.grip) bodies.push_back({grip.name, grip.jaw, grip.color});
    for (const Blade& blade : apparatus.blade) {
        bodies.push_back({blade.name, blade.body, blade.color});
    }
    machine_id_ = writer_.add_machine(bodies);
}

void MotionRecorder::add_frame(const WorkPiece& piece, const Drive& drive) {
    // A skin that is made anew in every frame changes only where matter was severed or
    // broke. Its smoothing,
    // told from angles, changes as it bends, and is kept as it first was.
    const bool same = skin_id_ >= 0 && skin_.triangle == piece.skin.triangle &&
                      skin_.position.size() == piece.skin.position.size();
    if (!same) {
        skin_ = piece.skin;
        skin_id_ = writer_.add_skin(skin_);
    }
    StoredFrame frame;
    frame.skin = skin_id_;
    frame.machine = machine_id_;
    frame.position.reserve(piece.position.size());
    for (const Vec3& p : piece.position) frame.position.push_back(p.cast<float>());
    frame.pose = body_poses(drive);
    writer_.add_frame(frame);
    ++frames_;
}

}  // namespace swage
