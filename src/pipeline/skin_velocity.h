// SPDX-License-Identifier: GPL-3.0-or-later
// How fast skins move, straight between frames, as the `motion` pass has it.
#pragma once

#include <vector>

#include "pipeline/frame_store.h"

namespace swage {

// Of each vertex of a body's skin in that frame [m/s]: to where it is in the next, also where that
// has another skin; in the last frame of the run from where it was in the one before. Zero in a run
// of one frame.
std::vector<Vec3> skin_velocity(const FrameStore& store, std::size_t body, int frame,
                                double frame_rate);

}  // namespace swage
