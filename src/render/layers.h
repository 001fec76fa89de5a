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
    // Where settings have passes of motion or pieces: which of the item's triangles; -1 where that
    // is seen as a plane, or nothing is.
    std::vector<int> triangle;
    // Where they have beauty: red, green, blue and alpha of each pixel, in light and blended as the
    // still is, premultiplied.
    std::vector<float> beauty;
};

// Of what shaders/layers.frag leaves, four numbers a pixel, rows from below; `radius`: of the
// stage.
Layers layers_of(int width, int height, const std::vector<float>& rgba, double radius);
// The triangles of the same picture, of what shaders/layers.frag leaves with TRIANGLES: numbers as
// they were drawn.
void set_triangles(const std::vector<float>& rgba, Layers& layers);
// Four numbers a pixel, rows from below, in rows from the top.
std::vector<float> from_above(int width, int height, const std::vector<float>& rgba);
// What the shader calls an item.
inline float layer_number(int item) { return static_cast<float>(item + 3); }

}  // namespace swage
