// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the key light and of the sky each pixel sees: normal and depth at half size; the
// shadow maps, about what is seen in these; what stands between it and the lamp; occlusion and
// shadow from these, blurred.
#pragma once

#include <vector>

#include "render/drawable.h"
#include "render/studio.h"
#include "render/targets.h"

namespace swage {

class VisibilityPass {
  public:
    // Of pictures of this size. `bare` must outlive it.
    VisibilityPass(const Gl& gl, const BareShapes& bare, int width, int height);

    // One after the other. The maps have to be in the block Frame from the second on.
    void draw_depth(const std::vector<Drawable>& drawables, bool ground) const;
    ShadowMaps fit_shadows(const std::vector<Drawable>& drawables, const FrameBlock& frame,
                           const Mat3& stage_from_light) const;
    void draw_shadows(const std::vector<Drawable>& drawables, const ShadowMaps& maps,
                      const Mat3& stage_from_light);
    void draw_visibility() const;

    GLuint result() const { return blurred_.color.id(); }

  private:
    const Gl& gl_;
    const BareShapes& bare_;
    Shader shadow_shader_, depth_shader_, ground_depth_shader_, blockers_shader_,
        visibility_shader_, blur_shader_;
    Target shadow_;  // maps one above the other, as many as were ever needed
    Target half_, blockers_, visibility_, blurred_;
};

}  // namespace swage
