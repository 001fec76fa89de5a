// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the key light and of the sky each pixel sees: the shadow map; normal and depth at
// half size; occlusion and shadow from these, blurred.
#pragma once

#include <vector>

#include "render/drawable.h"
#include "render/targets.h"

namespace swage {

class VisibilityPass {
  public:
    // Of pictures of this size. `bare` must outlive it.
    VisibilityPass(const Gl& gl, const BareShapes& bare, int width, int height);

    // One after the other.
    void draw_shadow(const std::vector<Drawable>& drawables) const;
    void draw_depth(const std::vector<Drawable>& drawables, bool ground) const;
    void draw_visibility() const;

    GLuint result() const { return blurred_.color.id(); }

  private:
    const Gl& gl_;
    const BareShapes& bare_;
    Shader shadow_shader_, depth_shader_, ground_depth_shader_, visibility_shader_, blur_shader_;
    Target shadow_, half_, visibility_, blurred_;
};

}  // namespace swage
