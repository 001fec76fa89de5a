// SPDX-License-Identifier: GPL-3.0-or-later
// What the passes draw into.
#pragma once

#include <vector>

#include "render/canvas.h"
#include "render/gl_handle.h"

namespace swage {

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

// What a picture is drawn into: samples and their mean, or what is smoothed afterwards; each is
// made when first needed.
struct PictureTargets {
    GLenum format;
    Target plain = {}, sampled = {}, smoothed = {};
};

// Throws Error(output) when the driver cannot make it.
Target make_target(const Gl& gl, int width, int height, const TargetFormat& format);

}  // namespace swage
