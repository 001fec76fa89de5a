// SPDX-License-Identifier: GPL-3.0-or-later
// The programs that a picture and its passes are drawn by, as far as there are several kinds.
#pragma once

#include <string>

#include "render/shaders.h"

namespace swage {

// Of surfaces in full size; with the define LINEAR, of their light.
struct SurfaceShaders {
    SurfaceShaders(const Gl& gl, const std::string& define)
        : surface(gl, "surface.vert", "surface.frag", {"visibility"}, define),
          textured(gl, "surface.vert", "surface.frag", {"visibility", "surface_texture"},
                   define.empty() ? "TEXTURED" : "TEXTURED\n#define " + define),
          ground(gl, "ground.vert", "ground.frag", {"visibility"}, define),
          backdrop(gl, "screen.vert", "backdrop.frag", {}, define),
          smooth(gl, "screen.vert", "smooth.frag", {"picture"}, define) {}

    Shader surface, textured, ground, backdrop, smooth;
};

// Of what is in the middle of each pixel; with the define TRIANGLES, of which triangle that is.
struct LayerShaders {
    LayerShaders(const Gl& gl, const std::string& define)
        : layer(gl, "surface.vert", "layers.frag", {}, define),
          horizon(gl, "screen.vert", "horizon.frag", {}, define) {}

    Shader layer, horizon;
};

}  // namespace swage
