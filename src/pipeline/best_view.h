// SPDX-License-Identifier: GPL-3.0-or-later
// From where tools hide least of the work-piece.
#pragma once

#include <string>
#include <vector>

#include "pipeline/action_box.h"
#include "pipeline/frame_store.h"
#include "render/settings.h"

namespace swage {

// Of the skin's area that faces the camera, square to the line of sight, the share that no tool
// hides, 0 to 1, in the half of the film in which tools hide most. What bodies hide of themselves
// and of each other does not count.
struct ChosenView {
    std::vector<CameraKey> camera;
    double seen = 1;         // from there
    double seen_before = 1;  // from where it stood
    // Where tools hide more than half: those that hide a tenth or more, most first.
    std::vector<std::string> hiding = {};
};

// A camera with angles open (see OpenAngles) stays where it stands, unless from lower, from
// another side or both clearly more is seen, of the area and as its share, and bodies do not hide
// much more of themselves. What tells is the run and which tools are drawn: pictures of any size,
// lens and zoom have one view.
ChosenView choose_view(const FrameStore& store, const RenderSettings& settings,
                       const ActionBox& action, const Quat& drawn_from_world);

}  // namespace swage
