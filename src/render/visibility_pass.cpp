// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/visibility_pass.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr float kNowhere = 1e4f;      // depth of the backdrop in the half-size pass [stage]
constexpr double kTurnedAway = -0.1;  // cosine to the lamp, as in shaders/shadow.glsl

Target shadow_target(const Gl& gl, int maps) {
    return make_target(gl, kShadowMapSide, maps * kShadowMapSide, {.depth_texture = true});
}

}  // namespace

VisibilityPass::VisibilityPass(const Gl& gl, const BareShapes& bare, int width, int height)
    : gl_(gl),
      bare_(bare),
      shadow_shader_(gl, "shadow.vert", "shadow.frag"),
      depth_shader_(gl, "surface.vert", "depth.frag"),
      ground_depth_shader_(gl, "ground.vert", "depth.frag"),
      blockers_shader_(gl, "screen.vert", "blockers.frag", {"normal_and_depth", "shadow_depth"}),
      visibility_shader_(gl, "screen.vert", "visibility.frag",
                         {"normal_and_depth", "shadow_depth", "blockers"}),
      blur_shader_(gl, "screen.vert", "blur.frag", {"visibility"}),
      shadow_(shadow_target(gl, 1)),
      half_(make_target(gl, (width + 1) / 2, (height + 1) / 2,
                        {.color = GL_RGBA32F, .depth_buffer = true})),
      blockers_(make_target(gl, half_.width, half_.height, {.color = GL_RGBA16})),
      visibility_(make_target(gl, half_.width, half_.height, {.color = GL_RGBA16})),
      blurred_(make_target(gl, half_.width, half_.height, {.color = GL_RGBA16})) {}

void VisibilityPass::draw_depth(const std::vector<Drawable>& drawables, bool ground) const {
    half_.bind(gl_);
    gl_.ClearColor(0, 0, 1, kNowhere);
    gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_shapes(gl_, depth_shader_, drawables);
    if (!ground) return;
    ground_depth_shader_.use();
    bare_.draw_ground();
}

ShadowMaps VisibilityPass::fit_shadows(const std::vector<Drawable>& drawables,
                                       const FrameBlock& frame,
                                       const Mat3& stage_from_light) const {
    std::vector<Box> casting;
    for (const Drawable& d : drawables) {
        if (!d.casting.empty()) casting.push_back(d.casting);
    }
    ShadowFit fit(stage_from_light, casting);
    // A pixel's place is `eye` and, by its depth, `ahead`, as many steps from the lower left.
    const Mat3 light_from_view =
        stage_from_light.transpose() * from_glm(glm::mat3(frame.view_from_stage)).transpose();
    const Vec3 eye = stage_from_light.transpose() * Vec3(frame.eye.x, frame.eye.y, frame.eye.z);
    const double x = double(frame.lens.x), y = double(frame.lens.y);
    const Vec3 right = light_from_view * Vec3(2 * x / half_.width, 0, 0),
               up = light_from_view * Vec3(0, 2 * y / half_.height, 0),
               corner = light_from_view * Vec3(-x, -y, -1);
    const Vec3 lamp_in_view = light_from_view.transpose() * Vec3::UnitZ();
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, half_.framebuffer.id());
    constexpr int kRows = 64;   // at once
    constexpr int kStride = 2;  // every other tells as much, for maps have a rim
    std::vector<float> pixels(4 * std::size_t(half_.width) * kRows);
    for (int first = 0; first < half_.height; first += kRows) {
        const int rows = std::min(kRows, half_.height - first);
        gl_.ReadPixels(0, first, half_.width, rows, GL_RGBA, GL_FLOAT, pixels.data());
        for (int row = 0; row < rows; row += kStride) {
            const float* pixel = &pixels[4 * std::size_t(row) * std::size_t(half_.width)];
            const Vec3 start = corner + (first + row + 0.5) * up;
            for (int column = 0; column < half_.width; column += kStride, pixel += 4 * kStride) {
                const double depth = double(pixel[3]);
                if (depth >= double(kNowhere) || !(depth > 0)) continue;
                const Vec3 normal(pixel[0], pixel[1], pixel[2]);
                if (normal.dot(lamp_in_view) < kTurnedAway) continue;
                fit.see(eye + depth * (start + (column + 0.5) * right), depth);
            }
        }
    }
    return fit.maps();
}

void VisibilityPass::draw_shadows(const std::vector<Drawable>& drawables, const ShadowMaps& maps,
                                  const Mat3& stage_from_light) {
    const int count = static_cast<int>(maps.map.size());
    if (count * kShadowMapSide > shadow_.height) shadow_ = shadow_target(gl_, count);
    if (count == 0) return;
    shadow_.bind(gl_);
    gl_.Clear(GL_DEPTH_BUFFER_BIT);
    gl_.Enable(GL_DEPTH_CLAMP);  // what sticks out of the map towards the light still casts
    gl_.Enable(GL_POLYGON_OFFSET_FILL);
    gl_.PolygonOffset(1.5f, 2.0f);
    for (int i = 0; i < count; ++i) {
        const Box& lit = maps.map[std::size_t(i)].lit;
        std::vector<Drawable> casting;
        for (const Drawable& d : drawables) {
            if (d.casting.empty()) continue;
            Box box = turned_box(d.casting, stage_from_light.transpose());
            box.high.z() = std::max(box.high.z(), lit.high.z());
            if (box.overlaps(lit)) casting.push_back(d);
        }
        if (casting.empty()) continue;
        gl_.Viewport(0, i * kShadowMapSide, kShadowMapSide, kShadowMapSide);
        shadow_shader_.use();
        shadow_shader_.set("map", i);
        draw_shapes(gl_, shadow_shader_, casting);
    }
    gl_.Disable(GL_POLYGON_OFFSET_FILL);
    gl_.Disable(GL_DEPTH_CLAMP);
}

void VisibilityPass::draw_visibility() const {
    gl_.Disable(GL_DEPTH_TEST);
    blockers_.bind(gl_);
    blockers_shader_.use();
    set_unit(gl_, 0, half_.color.id());
    set_unit(gl_, 1, shadow_.depth.id());
    bare_.cover_screen();
    visibility_.bind(gl_);
    visibility_shader_.use();
    set_unit(gl_, 2, blockers_.color.id());
    bare_.cover_screen();
    blurred_.bind(gl_);
    blur_shader_.use();
    set_unit(gl_, 0, visibility_.color.id());
    bare_.cover_screen();
    gl_.Enable(GL_DEPTH_TEST);
}

}  // namespace swage
