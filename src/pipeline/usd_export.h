// SPDX-License-Identifier: GPL-3.0-or-later
// The deforming skins of a run in one file of USD, from its motion file: what animation programs
// load.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/run_options.h"
#include "render/settings.h"

namespace swage {

struct UsdScene {
    std::string name;               // of the prim that holds all others
    std::vector<std::string> body;  // names; further bodies are called by their number
    int frames_per_second = 30;
    Up up = Up::automatic;
};

struct UsdOutcome {
    std::size_t bodies = 0;
    std::uintmax_t bytes = 0;
    std::vector<std::string> image;  // files beside it that it needs
};

// Frame numbers are time codes. Frames are read one at a time, several times over. Throws
// Error(command_line) when the run has no such frames, Error(foreign) where something else has the
// file's name, Error(output), Interrupted. The file, and the folder for it, appear only when whole.
UsdOutcome export_usd(const FrameStore& store, const UsdScene& scene, const FrameRange& frames,
                      const std::filesystem::path& file);

}  // namespace swage
