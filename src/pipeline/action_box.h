// SPDX-License-Identifier: GPL-3.0-or-later
// What the pictures of a run frame.
#pragma once

#include "pipeline/frame_store.h"
#include "render/framed_action.h"
#include "render/settings.h"

namespace swage {

// The skin in all frames of the run, whichever of them are drawn, and as much of the machines as
// lies near. Of what broke into pieces, the farthest ones that together have a twentieth of a
// body's surface may leave the picture: chips fly far.
struct ActionBox {
    Box bounds;
    double ground_height = 0;  // y
    FramedAction framed;
};
// As drawn, with y up; of the machines counts what is seen of them. `calm`: where the camera goes
// along with the bodies, the frames over which it gathers way and slows down, fewer in a short
// film; 0: it stays.
ActionBox find_action(const FrameStore& store, const RenderSettings& settings,
                      const Quat& drawn_from_world, double calm = 0);

}  // namespace swage
