// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/box.h"

namespace swage {

// What the pictures of a film frame, with y up [m].
struct FramedAction {
    Box bounds;
    // Points that together reach as far as the action does in every direction; none: the corners of
    // the bounds.
    std::vector<Vec3> outline = {};
    // Of a camera that goes along: where it is in each still of the film, and what the bounds and
    // the outline are relative to. Empty: it stays.
    std::vector<Vec3> way = {};
};

}  // namespace swage
