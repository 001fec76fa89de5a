// SPDX-License-Identifier: GPL-3.0-or-later
// What of a run's machines is in its pictures.
#pragma once

#include <optional>

#include "pipeline/frame_store.h"
#include "render/settings.h"

namespace swage {

// How a tool, grip or blade looks; none where it is not to be seen.
std::optional<SurfaceMaterial> look_of(const DrawnPart& part, const RenderSettings& settings);

// Throws Error(command_line) where a name of `hide` is that of no part of any machine.
void refuse_unknown_parts(const FrameStore& store, const RenderSettings& settings);

}  // namespace swage
