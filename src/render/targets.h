// SPDX-License-Identifier: GPL-3.0-or-later
// What the passes draw into.
#pragma once

#include <vector>

#include "render/canvas.h"
#include "render/gl_handle.h"
#include "render/settings.h"

namespace swage {

inline constexpr int kSamples = 4;  // of a pixel
// Above this, multisampling so many small triangles takes a third of a picture's time, and the eye
// hardly tells: edges are softened afterwards instead.
inline constexpr std::size_t kMostMultisampledTriangles = 60'000;
inline constexpr long kMostMultisampledPixels = 4096l * 4096l;

// A framebuffer with a colour texture, a depth buffer, or both.
struct Target {
    GlHandle framebuffer, color, depth;
    int width = 0, height = 0;

    void bind(const Gl& gl) const;
};

// Colour in a texture of the given format (0: none).
struct TargetFormat {
    GLenum color = 0;
    bool depth_texture = false;  // a depth that can be read back in a shader
    bool depth_buffer = false;
    int samples = 0;  // above 0: buffers for multisampling instead of textures
};

// Of a still; of its light, which may be brighter than white; of what is not blended.
inline constexpr TargetFormat kStillFormat{.color = GL_RGBA8, .depth_buffer = true},
    kLightFormat{.color = GL_RGBA16F, .depth_buffer = true},
    kLayerFormat{.color = GL_RGBA32F, .depth_buffer = true};

// What a picture is drawn into: samples and their mean, or what is smoothed afterwards; each is
// made when first needed.
struct PictureTargets {
    GLenum format;
    Target plain = {}, sampled = {}, smoothed = {};
};

// Throws Error(output) when the driver cannot make it.
Target make_target(const Gl& gl, int width, int height, const TargetFormat& format);

// Throws Error(output) where pictures are larger than the driver can make them with their passes,
// and tells the largest of their shape.
void try_targets(const Gl& gl, const RenderSettings& settings);

}  // namespace swage
