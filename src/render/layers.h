// SPDX-License-Identifier: GPL-3.0-or-later
// What is behind each pixel's middle, for compositing: nothing is blended across edges.
#pragma once

#include <vector>

#include "base/math.h"

namespace swage {

inline constexpr float kNoDepth = 1e10f;
inline constexpr int kNothingThere = -1, kGroundThere = -2;

struct Layers {
    int width = 0, height = 0;            // rows from the top
    std::vector<float> depth;             // along the view [m]; kNoDepth where nothing is
    std::vector<Eigen::Vector3f> normal;  // on the side that is seen, as drawn; zero likewise
    std::vector<int> item;                // which of the picture's, or one of those above
};

// Of what shaders/layers.frag leaves, four numbers a pixel, rows from below; `radius`: of the
// stage.
Layers layers_of(int width, int height, const std::vector<float>& rgba, double radius);
// What the shader calls an item.
inline float layer_number(int item) { return static_cast<float>(item + 3); }

}  // namespace swage
