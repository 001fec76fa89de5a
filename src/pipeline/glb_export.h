// SPDX-License-Identifier: GPL-3.0-or-later
// The deforming skins of a run, its machines, and the camera of its stills, in one file of binary
// glTF, from its motion file: what viewers, engines and web pages load.
#pragma once

#include <filesystem>

#include "pipeline/export_scene.h"
#include "pipeline/frame_store.h"

namespace swage {

// Frames are read one at a time, twice over. Throws as export_usd() does, and Error(resources)
// where it would be more than such a file holds.
ExportOutcome export_glb(const FrameStore& store, const ExportScene& scene,
                         const FrameRange& frames, const std::filesystem::path& file);

}  // namespace swage
