// SPDX-License-Identifier: GPL-3.0-or-later
// How far what is seen in a still moves in the picture until the next, and how far from where it
// was in the one before.
#pragma once

#include <vector>

#include "render/camera.h"
#include "render/layers.h"
#include "render/renderer.h"

namespace swage {

// Of another still: what it is taken with, and where each of the picture's items is then.
struct MovedItem {
    Pose pose;
    // Of a skin that changes its form: the places, as many as the item's mesh has now; empty: it
    // moves by the pose alone.
    std::vector<Vec3> position;
};
struct MovedPicture {
    View view;
    std::vector<MovedItem> item;
};

// Of each pixel, rows from the top, in pixels of the picture, x to the right and y up: from what is
// seen in its middle to where that is in the still after it, then to where it was in the one
// before. Zero where nothing is, and towards a still that there is none of (null).
std::vector<Eigen::Vector4f> motion_of(const Layers& layers, const Picture& picture,
                                       const View& view, const Lens& lens,
                                       const MovedPicture* after, const MovedPicture* before);

}  // namespace swage
