// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, grips and blades in USD: each a mesh that moves, below its stage.
#pragma once

#include <string>
#include <vector>

#include "geometry/usd_text.h"
#include "pipeline/machine_tracks.h"

namespace swage {

// A scope in the prim that is open, unless there are none; `look`: where each look is.
void write_usd_machines(UsdText& out, const MachineTracks& machines,
                        const std::vector<StageFrames>& stages,
                        const std::vector<std::string>& look);

}  // namespace swage
