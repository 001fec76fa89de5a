// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, grips and blades in USD: each a mesh that moves, below its stage, which is to be seen as
// long as it lasts.
#pragma once

#include <string>
#include <vector>

#include "geometry/box.h"
#include "geometry/usd_look.h"
#include "pipeline/frame_store.h"
#include "pipeline/run_options.h"
#include "render/settings.h"

namespace swage {

struct UsdStage {
    std::string name;
    int last = 1;  // frame
};

// What a machine is under that comes in that frame; its number, where no stage has it.
std::string stage_of_machine(const std::vector<UsdStage>& stages, int machine, int first_frame);

class UsdMachines {
  public:
    // What pictures with these settings show.
    UsdMachines(const FrameStore& store, const RenderSettings& settings, const FrameRange& frames,
                const std::vector<UsdStage>& stages)
        : store_(store), settings_(settings), frames_(frames), stages_(stages) {}

    // All frames, in their order, before anything is asked.
    void look_at(int frame, const StoredFrame& stored, UsdLooks& looks);

    std::size_t count() const;    // of what is there to be written
    Box box(bool endless) const;  // of all that, all along, without or with what is endless
    // A scope in the prim that is open; `materials`: where the looks are.
    void write(UsdText& out, const std::string& materials, const UsdLooks& looks) const;

  private:
    struct Part {
        DrawnPart drawn;
        int look;
        std::size_t number;  // in the machine
        std::vector<Pose> pose;
    };
    struct Machine {
        int id, first;  // the frame that it comes in
        std::vector<Part> part;
        std::vector<char> is_seen;  // in each of the frames
    };
    void write(UsdText& out, const Machine& machine, const std::string& materials,
               const UsdLooks& looks) const;

    const FrameStore& store_;
    const RenderSettings settings_;
    const FrameRange frames_;
    const std::vector<UsdStage>& stages_;
    std::vector<Machine> machine_;
    Box box_, endless_;
};

}  // namespace swage
