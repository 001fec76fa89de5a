// SPDX-License-Identifier: GPL-3.0-or-later
// The deforming skins of a run, its machines, and the camera and lamp of its stills, in one file of
// USD, from its motion file: what animation programs load.
#pragma once

#include <filesystem>

#include "pipeline/export_scene.h"
#include "pipeline/frame_store.h"

namespace swage {

// Frame numbers are time codes. Frames are read one at a time, several times over. Throws
// Error(command_line) when the run has no such frames, Error(foreign) where something else has the
// file's name, Error(output), Interrupted. The file, and the folder for it, appear only when whole.
ExportOutcome export_usd(const FrameStore& store, const ExportScene& scene,
                         const FrameRange& frames, const std::filesystem::path& file);

}  // namespace swage
