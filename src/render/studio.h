// SPDX-License-Identifier: GPL-3.0-or-later
// Where lights, floor and shadow map stand for an action of any size, and what the shaders are
// told of it. Mathematics only.
#pragma once

#include <array>
#include <limits>

#include "render/camera.h"
#include "render/shadow_fit.h"

namespace swage {

// The block Frame of shaders/frame.glsl, in its layout.
struct FrameBlock {
    glm::mat4 clip_from_stage, view_from_stage, stage_from_view;
    std::array<glm::mat4, kMostShadowMaps> shadow_from_stage = {};
    std::array<glm::vec4, kMostShadowMaps> shadow = {};
    glm::vec4 shadow_parts = glm::vec4(0), eye, lens, size, half_size, key, fill, rim, ground;

    void set_shadows(const ShadowMaps& maps);
};

// Stage space: the action's centre is the origin, its half diagonal is 1.
struct Stage {
    Vec3 center = Vec3::Zero();
    double radius = 1;

    explicit Stage(const Box& action_bounds);
    Box box(const Box& world) const;
    // For a mesh whose positions are given relative to `origin`.
    glm::mat4 from_mesh(const Pose& world_from_mesh, const Vec3& origin) const;
};

// Towards them from everywhere, of length 1, in the world that has y up.
struct Lamps {
    Vec3 key, fill, rim;
};
inline constexpr double kKeyLight[] = {0.84, 0.81, 0.765};  // KEY of shaders/light.glsl
Lamps lamps_of(const LightPlace& light, double front);
Mat3 world_from_key_light(const LightPlace& light, double front);  // its third axis points there
// The azimuth of the film's first view; straight down there is none, and any will do.
double front_of(const View& first);

// Where in the world that is which a picture shows, but for what has no end.
struct Extent {
    Box shown;                                                 // all of it; never empty
    double nearest = std::numeric_limits<double>::infinity();  // to the eye [m], or less
};

// `front` is the azimuth of the film's first view: the lights stand about it and stay in the
// world. Without the maps of its shadows.
FrameBlock frame_block(const RenderSettings& settings, const Stage& stage, const Extent& extent,
                       const View& view, double ground_height, double front);

}  // namespace swage
