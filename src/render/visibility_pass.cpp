// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/visibility_pass.h"

#include <algorithm>
#include <iterator>

#include "render/studio.h"

namespace swage {

namespace {

constexpr float kNowhere = 1e4f;  // depth of the backdrop in the half-size pass [stage]

}  // namespace

VisibilityPass::VisibilityPass(const Gl& gl, const BareShapes& bare, int width, int height)
    : gl_(gl),
      bare_(bare),
      shadow_shader_(gl, "shadow.vert", "shadow.frag"),
      depth_shader_(gl, "surface.vert", "depth.frag"),
      ground_depth_shader_(gl, "ground.vert", "depth.frag"),
      visibility_shader_(gl, "screen.vert", "visibility.frag",
                         {"normal_and_depth", "shadow_depth"}),
      blur_shader_(gl, "screen.vert", "blur.frag", {"visibility"}),
      shadow_(make_target(gl, kShadowMapSide, kShadowMapSide, {.depth_texture = true})),
      half_(make_target(gl, (width + 1) / 2, (height + 1) / 2,
                        {.color = GL_RGBA32F, .depth_buffer = true})),
      visibility_(make_target(gl, half_.width, half_.height, {.color = GL_RGBA16})),
      blurred_(make_target(gl, half_.width, half_.height, {.color = GL_RGBA16})) {}

void VisibilityPass::draw_shadow(const std::vector<Drawable>& drawables) const {
    shadow_.bind(gl_);
    gl_.Clear(GL_DEPTH_BUFFER_BIT);
    gl_.Enable(GL_DEPTH_CLAMP);  // what sticks out of the map towards the light still casts
    gl_.Enable(GL_POLYGON_OFFSET_FILL);
    gl_.PolygonOffset(1.5f, 2.0f);
    std::vector<Drawable> casting;
    std::copy_if(drawables.begin(), drawables.end(), std::back_inserter(casting),
                 [](const Drawable& d) { return !d.item->endless; });
    draw_shapes(gl_, shadow_shader_, casting);
    gl_.Disable(GL_POLYGON_OFFSET_FILL);
    gl_.Disable(GL_DEPTH_CLAMP);
}

void VisibilityPass::draw_depth(const std::vector<Drawable>& drawables, bool ground) const {
    half_.bind(gl_);
    gl_.ClearColor(0, 0, 1, kNowhere);
    gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_shapes(gl_, depth_shader_, drawables);
    if (!ground) return;
    ground_depth_shader_.use();
    bare_.draw_ground();
}

void VisibilityPass::draw_visibility() const {
    gl_.Disable(GL_DEPTH_TEST);
    visibility_.bind(gl_);
    visibility_shader_.use();
    set_unit(gl_, 0, half_.color.id());
    set_unit(gl_, 1, shadow_.depth.id());
    bare_.cover_screen();
    blurred_.bind(gl_);
    blur_shader_.use();
    set_unit(gl_, 0, visibility_.color.id());
    bare_.cover_screen();
    gl_.Enable(GL_DEPTH_TEST);
}

}  // namespace swage
