// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/studio.h"

#include <algorithm>

namespace swage {

namespace {

// Relative to the film's first view [rad].
constexpr double kKeyAzimuth = -0.80, kKeyElevation = 0.90;
constexpr double kFillAzimuth = 0.95, kFillElevation = 0.25;
constexpr double kRimAzimuth = 2.55, kRimElevation = 0.55;

constexpr double kLampSize = 0.12;  // tangent of the key lamp's half angle: how soft shadows are
constexpr double kGroundFade = 2.2, kGroundEnd = 9.0;  // [stage]

Vec3 towards(double azimuth, double elevation) { return orbit_rotation(azimuth, elevation).col(2); }

Eigen::Vector4f four(const Vec3& v, double w) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
            static_cast<float>(w)};
}
Eigen::Vector4f four(double x, double y, double z, double w) { return four(Vec3(x, y, z), w); }

struct ShadowBox {
    Eigen::Matrix4d map_from_stage;  // to 0..1
    double side;                     // of the map [stage]
    double depth;                    // of the map [stage]
};

// A square map along the light, as small as holds the box.
ShadowBox fit_shadow(const Box& box, const Mat3& stage_from_light) {
    Box lit;
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner = {(i & 1 ? box.high : box.low).x(), (i & 2 ? box.high : box.low).y(),
                             (i & 4 ? box.high : box.low).z()};
        lit.grow(stage_from_light.transpose() * corner);
    }
    const double side = 1.06 * std::max(lit.size().x(), lit.size().y());
    const double depth = 1.06 * lit.size().z() + 1e-3;
    const Vec3 c = lit.center();
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() =
        Vec3(1 / side, 1 / side, -1 / depth).asDiagonal() * stage_from_light.transpose();
    m.topRightCorner<3, 1>() = Vec3(0.5 - c.x() / side, 0.5 - c.y() / side, 0.5 + c.z() / depth);
    return {m, side, depth};
}

}  // namespace

Stage::Stage(const Box& bounds) {
    if (bounds.empty()) return;
    center = bounds.center();
    radius = std::max(0.5 * bounds.size().norm(), 1e-9);
}

Box Stage::box(const Box& world) const {
    return {(world.low - center) / radius, (world.high - center) / radius};
}

Eigen::Matrix4f Stage::from_mesh(const Pose& world_from_mesh, const Vec3& origin) const {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = world_from_mesh.rotation.toRotationMatrix() / radius;
    m.topRightCorner<3, 1>() = (world_from_mesh * origin - center) / radius;
    return m.cast<float>();
}

FrameBlock frame_block(const RenderSettings& settings, const Stage& stage, const Box& shown,
                       const View& world_view, double ground_height, double front) {
    View view = world_view;
    view.eye = (view.eye - stage.center) / stage.radius;
    const Box box = stage.box(shown);
    const Lens lens = lens_of(settings);
    DepthRange depth = depth_range(box, view);
    if (settings.ground) depth.far += kGroundEnd;

    FrameBlock frame;
    const Eigen::Matrix4d looking = view_from_world(view);
    frame.clip_from_stage = (clip_from_view(lens, depth) * looking).cast<float>();
    frame.view_from_stage = looking.cast<float>();
    frame.stage_from_view = looking.inverse().cast<float>();
    frame.eye = four(view.eye, 1);
    frame.lens = four(lens.tangent_x, lens.tangent_y, depth.near, depth.far);
    const auto size = [](int w, int h) { return four(w, h, 1.0 / w, 1.0 / h); };
    frame.size = size(settings.width, settings.height);
    frame.half_size = size((settings.width + 1) / 2, (settings.height + 1) / 2);
    frame.key = four(towards(front + kKeyAzimuth, kKeyElevation), 0);
    frame.fill = four(towards(front + kFillAzimuth, kFillElevation), 0);
    frame.rim = four(towards(front + kRimAzimuth, kRimElevation), 0);
    const double ground = (ground_height - stage.center.y()) / stage.radius;
    frame.ground = four(ground, kGroundFade, kGroundEnd, 0);

    Box casting = box;
    if (settings.ground) casting.grow({box.center().x(), ground, box.center().z()});
    const ShadowBox map = fit_shadow(casting, orbit_rotation(front + kKeyAzimuth, kKeyElevation));
    frame.shadow_from_stage = map.map_from_stage.cast<float>();
    frame.shadow = four(map.side / kShadowMapSide, 1.0 / kShadowMapSide,
                        kLampSize * map.depth / map.side, 1.5 / kShadowMapSide);
    return frame;
}

}  // namespace swage
