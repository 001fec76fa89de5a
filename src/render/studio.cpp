// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/studio.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swage {

namespace {

// Relative to the film's first view, with the key lamp where it usually is [rad].
constexpr double kFillAzimuth = 0.95, kFillElevation = 0.25;
constexpr double kRimAzimuth = 2.55, kRimElevation = 0.55;

constexpr double kGroundFade = 2.2, kGroundEnd = 9.0;  // [stage]
// Depth has so many digits: what lies farther behind the action is not drawn, nor what is nearer
// to the eye than this share of the farthest.
constexpr double kFarthest = 100;  // [stage]
constexpr double kNearest = 1e-4;

Vec3 towards(double azimuth, double elevation) { return orbit_rotation(azimuth, elevation).col(2); }

glm::vec4 four(const Vec3& v, double w) { return {to_glm(v), w}; }

// How far before the eye the picture's lower edge meets the ground; infinite where it does not.
double nearest_ground(const View& view, const Lens& lens, double ground) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int right : {-1, 1}) {
        for (const int up : {-1, 1}) {
            const Vec3 sight =
                view.world_from_view * Vec3(right * lens.tangent_x, up * lens.tangent_y, -1);
            const double depth = (ground - view.eye.y()) / sight.y();
            if (depth > 0) nearest = std::min(nearest, depth);
        }
    }
    return nearest;
}

// Nothing that is drawn is nearer or farther.
DepthRange depth_drawn(const RenderSettings& settings, const Stage& stage, const Extent& extent,
                       const View& view, const Lens& lens, double ground) {
    const double behind = depth_range(stage.box(extent.shown), view).far;
    const double far = std::min(behind, view.eye.norm() + kFarthest) + kGroundEnd;
    const double slant = std::hypot(1.0, lens.tangent_x, lens.tangent_y);
    double near = extent.nearest / (stage.radius * slant);
    if (settings.ground) near = std::min(near, nearest_ground(view, lens, ground));
    return {std::clamp(0.9 * near, kNearest * far, 0.5 * far), far};
}

}  // namespace

Lamps lamps_of(const LightPlace& light, double front) {
    const double turned = front + (light.azimuth - LightPlace().azimuth);
    return {towards(front + light.azimuth, light.elevation),
            towards(turned + kFillAzimuth, kFillElevation),
            towards(turned + kRimAzimuth, kRimElevation)};
}

Mat3 world_from_key_light(const LightPlace& light, double front) {
    return orbit_rotation(front + light.azimuth, light.elevation);
}

double front_of(const View& first) {
    const Vec3 back = first.world_from_view.col(2);
    return std::hypot(back.x(), back.z()) > 1e-6 ? std::atan2(back.x(), back.z()) : 0;
}

Stage::Stage(const Box& bounds) {
    if (bounds.empty()) return;
    center = bounds.center();
    radius = std::max(0.5 * bounds.size().norm(), 1e-9);
}

Box Stage::box(const Box& world) const {
    return {(world.low - center) / radius, (world.high - center) / radius};
}

glm::mat4 Stage::from_mesh(const Pose& world_from_mesh, const Vec3& origin) const {
    const Vec3 moved = (world_from_mesh * origin - center) / radius;
    return glm::scale(glm::translate(glm::dmat4(1), to_glm(moved)) *
                          glm::mat4_cast(to_glm(world_from_mesh.rotation)),
                      glm::dvec3(1 / radius));
}

FrameBlock frame_block(const RenderSettings& settings, const Stage& stage, const Extent& extent,
                       const View& world_view, double ground_height, double front) {
    View view = world_view;
    view.eye = (view.eye - stage.center) / stage.radius;
    const Lens lens = lens_of(settings);
    const double ground = (ground_height - stage.center.y()) / stage.radius;
    const DepthRange depth = depth_drawn(settings, stage, extent, view, lens, ground);

    FrameBlock frame;
    const glm::dmat4 looking = view_from_world(view);
    frame.clip_from_stage = clip_from_view(lens, depth) * looking;
    frame.view_from_stage = looking;
    frame.stage_from_view = glm::inverse(looking);
    frame.eye = four(view.eye, 1);
    frame.lens = glm::dvec4(lens.tangent_x, lens.tangent_y, depth.near, depth.far);
    const auto size = [](int w, int h) { return glm::dvec4(w, h, 1.0 / w, 1.0 / h); };
    frame.size = size(settings.width, settings.height);
    frame.half_size = size((settings.width + 1) / 2, (settings.height + 1) / 2);
    const Lamps lamps = lamps_of(settings.light, front);
    frame.key = four(lamps.key, std::sin(front));
    frame.fill = four(lamps.fill, std::cos(front));
    frame.rim = four(lamps.rim, 0);
    const bool is_clear = settings.background == Background::transparent;
    frame.ground = glm::dvec4(ground, kGroundFade, kGroundEnd, is_clear ? 1 : 0);
    return frame;
}

void FrameBlock::set_shadows(const ShadowMaps& maps) {
    for (std::size_t i = 0; i < maps.map.size(); ++i) {
        const ShadowMap& map = maps.map[i];
        shadow_from_stage[i] = map.map_from_stage;
        shadow[i] = glm::dvec4(map.side / kShadowMapSide, map.side, map.depth, 0);
    }
    shadow_parts =
        glm::dvec4(maps.nearest, maps.per_log, static_cast<double>(maps.map.size()), kLampSize);
}

}  // namespace swage
