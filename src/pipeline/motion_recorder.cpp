// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/motion_recorder.h"

#include "pipeline/signals.h"

namespace swage {

std::vector<Pose> part_poses(const Drive& drive) {
    std::vector<Pose> poses = drive.world_from_tool;
    poses.insert(poses.end(), drive.world_from_grip.begin(), drive.world_from_grip.end());
    poses.insert(poses.end(), drive.world_from_blade.begin(), drive.world_from_blade.end());
    return poses;
}

MotionRecorder::MotionRecorder(const std::filesystem::path& file, const std::filesystem::path& from,
                               const MotionMark& mark, const std::vector<WorkPiece>& bodies,
                               const std::vector<int>& skins, bool stays)
    : writer_(file, from, mark, stays), machine_id_(writer_.machine_count() - 1) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        skin_.push_back({bodies[b].skin, skins.at(b)});
    }
}

MotionRecorder::~MotionRecorder() { set_frames_at_stake(false); }

void MotionRecorder::set_machine(const Apparatus& apparatus) {
    std::vector<DrawnPart> parts;
    for (const Tool& tool : apparatus.tool) {
        parts.push_back({tool.name, surface_of(tool.shape), tool.color, tool.finish});
    }
    for (const Grip& grip : apparatus.grip) parts.push_back({grip.name, grip.jaw, grip.color});
    for (const Blade& blade : apparatus.blade) {
        parts.push_back({blade.name, blade.body, blade.color});
    }
    machine_id_ = writer_.add_machine(parts);
}

void MotionRecorder::add_frame(const std::vector<WorkPiece>& bodies, const Drive& drive,
                               const std::vector<SkinFieldValues>& fields) {
    StoredFrame frame;
    skin_.resize(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const WorkPiece& piece = bodies[b];
        Skin& stored = skin_[b];
        const bool same = stored.id >= 0 && stored.mesh.triangle == piece.skin.triangle &&
                          stored.mesh.position.size() == piece.skin.position.size();
        if (!same) {
            stored.mesh = piece.skin;
            stored.id = writer_.add_skin(stored.mesh);
        }
        frame.body.push_back({stored.id, piece.position, fields.at(b)});
    }
    frame.machine = machine_id_;
    frame.pose = part_poses(drive);
    writer_.add_frame(frame);
    set_frames_at_stake(true);
}

std::vector<int> MotionRecorder::skins() const {
    std::vector<int> ids;
    for (const Skin& skin : skin_) ids.push_back(skin.id);
    return ids;
}

}  // namespace swage
