// SPDX-License-Identifier: GPL-3.0-or-later
// Camera and key lamp of a run's stills in USD.
#pragma once

#include "geometry/usd_text.h"
#include "pipeline/view_track.h"

namespace swage {

// Into the prim that is open, which has the world's axes.
void write_usd_view(UsdText& out, const Shot& shot, int first_frame, const ViewTrack& view);

}  // namespace swage
