// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the bodies and the machine at them into the motion file, frame by frame, storing a skin or
// a machine anew only when it has changed.
#pragma once

#include "machines/machine.h"
#include "pipeline/frame_store.h"
#include "pipeline/work_piece.h"

namespace swage {

// Poses of what a machine is made of: tools, then grips, then blades.
std::vector<Pose> part_poses(const Drive& drive);

class MotionRecorder {
  public:
    // `fields`: that each frame is to hold.
    MotionRecorder(const std::filesystem::path& file, const std::vector<SkinField>& fields)
        : writer_(file, fields) {}
    // Goes on behind the mark, where the bodies had these skins, at the machine that was last.
    // `stays`: as FrameStoreWriter has it.
    MotionRecorder(const std::filesystem::path& file, const std::filesystem::path& from,
                   const MotionMark& mark, const std::vector<WorkPiece>& bodies,
                   const std::vector<int>& skins, bool stays);
    // From its first frame on and as long as it lives, frames are at stake (pipeline/signals.h).
    ~MotionRecorder();

    void set_machine(const Apparatus& apparatus);
    // `fields`: of each body.
    void add_frame(const std::vector<WorkPiece>& bodies, const Drive& drive,
                   const std::vector<SkinFieldValues>& fields);
    int frame_count() const { return writer_.frame_count(); }
    // As FrameStoreWriter has these.
    void keep(const std::filesystem::path& as) { writer_.keep(as); }
    const MotionMark& mark() const { return writer_.mark(); }
    std::vector<int> skins() const;  // of each body
    void finish() { writer_.finish(); }

  private:
    FrameStoreWriter writer_;
    struct Skin {
        TriMesh mesh;  // as last stored
        int id = -1;
    };
    std::vector<Skin> skin_;  // of each body
    int machine_id_ = -1;
};

}  // namespace swage
