// SPDX-License-Identifier: GPL-3.0-or-later
// Where the stills of a run are taken from.
#pragma once

#include <optional>

#include "pipeline/action_box.h"
#include "pipeline/best_view.h"
#include "pipeline/frame_store.h"
#include "render/camera.h"
#include "render/settings.h"

namespace swage {

struct Shot {
    Quat drawn_from_world;             // the renderer has y up
    RenderSettings settings;           // as it is to have them
    ActionBox action;                  // as drawn
    std::optional<ChosenView> chosen;  // where angles of the camera were open

    CameraPath camera() const { return {settings, action.framed}; }
};
Quat drawn_from_up(Up up);  // from the world
Shot shot_of(const FrameStore& store, const RenderSettings& wanted);

}  // namespace swage
