// SPDX-License-Identifier: GPL-3.0-or-later
// Where things stand over the frames, in USD. Whole numbers and words its readers hold.
#pragma once

#include <vector>

#include "geometry/frame_changes.h"
#include "geometry/usd_text.h"

namespace swage {

// Into a prim that is open: where it stands in each frame from the first on.
void write_usd_poses(UsdText& out, int first, const std::vector<Pose>& of_frame);

}  // namespace swage
