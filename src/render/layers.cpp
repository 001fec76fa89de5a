// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/layers.h"

#include <cmath>

namespace swage {

namespace {

// Source: Z. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
// JCGT 3(2), 2014: octahedral.
Eigen::Vector3f unfolded(float x, float y) {
    const float z = 1 - std::abs(x) - std::abs(y), fold = std::max(-z, 0.0f);
    return Eigen::Vector3f(x + (x >= 0 ? -fold : fold), y + (y >= 0 ? -fold : fold), z)
        .normalized();
}

}  // namespace

Layers layers_of(int width, int height, const std::vector<float>& rgba, double radius) {
    const std::size_t row = static_cast<std::size_t>(width), pixels = rgba.size() / 4;
    Layers layers{width,
                  height,
                  std::vector<float>(pixels, kNoDepth),
                  std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::Zero()),
                  std::vector<int>(pixels, kNothingThere),
                  {},
                  {}};
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* from = &rgba[4 * i];
        if (from[3] == 0) continue;
        const std::size_t to = (std::size_t(height) - 1 - i / row) * row + i % row;
        layers.normal[to] = unfolded(from[0], from[1]);
        layers.depth[to] = static_cast<float>(radius * double(from[2]));
        layers.item[to] = static_cast<int>(std::lround(from[3])) - 3;
    }
    return layers;
}

std::vector<float> from_above(int width, int height, const std::vector<float>& rgba) {
    const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(width);
    std::vector<float> turned;
    turned.reserve(rgba.size());
    for (int y = height - 1; y >= 0; --y) {
        turned.insert(turned.end(), rgba.begin() + y * row, rgba.begin() + (y + 1) * row);
    }
    return turned;
}

void set_triangles(const std::vector<float>& rgba, Layers& layers) {
    const std::vector<float> turned = from_above(layers.width, layers.height, rgba);
    layers.triangle.assign(layers.item.size(), -1);
    for (std::size_t i = 0; i < layers.triangle.size(); ++i) {
        // Two programs may round one edge in two ways.
        const bool is_same = turned[4 * i] == layer_number(layers.item[i]);
        if (is_same && layers.item[i] >= 0) {
            layers.triangle[i] = static_cast<int>(turned[4 * i + 1]);
        }
    }
}

}  // namespace swage
