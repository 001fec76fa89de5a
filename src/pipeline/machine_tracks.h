// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, grips and blades as they are exported: each keeps its shape and moves, and is to be seen
// as long as its stage lasts.
#pragma once

#include <string>
#include <vector>

#include "geometry/box.h"
#include "geometry/mesh_looks.h"
#include "pipeline/frame_store.h"
#include "pipeline/run_options.h"
#include "render/settings.h"

namespace swage {

struct StageFrames {
    std::string name;
    int last = 1;  // frame
};

// What a machine is under that comes in that frame; its number, where no stage has it.
std::string stage_of_machine(const std::vector<StageFrames>& stages, int machine, int first_frame);

class MachineTracks {
  public:
    struct Part {
        DrawnPart drawn;
        int look;
        std::size_t number;      // in the machine
        std::vector<Pose> pose;  // in each frame from the machine's first on
    };
    struct Machine {
        int id, first;  // the frame that it comes in
        std::vector<Part> part;
        std::vector<char> is_seen;  // in each of the frames
    };

    // What pictures with these settings show.
    MachineTracks(const FrameStore& store, const RenderSettings& settings, const FrameRange& frames)
        : store_(store), settings_(settings), frames_(frames) {}

    // All frames, in their order, before anything is asked.
    void look_at(int frame, const StoredFrame& stored, MeshLooks& looks);

    const std::vector<Machine>& all() const { return machine_; }
    const FrameRange& frames() const { return frames_; }
    std::size_t count() const;    // of parts
    Box box(bool endless) const;  // of them, all along, without or with what is endless

  private:
    const FrameStore& store_;
    const RenderSettings settings_;
    const FrameRange frames_;
    std::vector<Machine> machine_;
    Box box_, endless_;
};

}  // namespace swage
