// SPDX-License-Identifier: GPL-3.0-or-later
// The deforming skins of a run, its machines, and the camera and lamp of its stills, in one file of
// USD, from its motion file: what animation programs load.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/run_options.h"
#include "pipeline/usd_machine.h"
#include "render/settings.h"

namespace swage {

struct UsdScene {
    std::string name;               // of the prim that holds all others
    std::vector<std::string> body;  // names; further bodies are called by their number
    RenderSettings render = {};     // of its stills
    std::vector<UsdStage> stage = {};
    bool tools = true;  // as far as its stills have them

    RenderSettings shown() const {
        RenderSettings settings = render;
        settings.tools = render.tools && tools;
        return settings;
    }
};

struct UsdOutcome {
    std::size_t bodies = 0, tools = 0;  // tools: grips and blades too
    std::uintmax_t bytes = 0;
    double expected = 0;             // bytes, before it was written; where disk lacks, it is told
    std::vector<std::string> image;  // files beside it that it needs
};

// Frame numbers are time codes. Frames are read one at a time, several times over. Throws
// Error(command_line) when the run has no such frames, Error(foreign) where something else has the
// file's name, Error(output), Interrupted. The file, and the folder for it, appear only when whole.
UsdOutcome export_usd(const FrameStore& store, const UsdScene& scene, const FrameRange& frames,
                      const std::filesystem::path& file);

}  // namespace swage
