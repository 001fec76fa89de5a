// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/shot.h"

#include "render/legend.h"

namespace swage {

namespace {

constexpr double kCalm = 0.15;  // [s] of film, over which a camera that goes along gathers way

}  // namespace

// The axes take turns.
Quat drawn_from_up(Up up) {
    Mat3 turn = Mat3::Identity();
    if (up == Up::z || up == Up::minus_z) turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;
    if (up == Up::x || up == Up::minus_x) turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    if (up >= Up::minus_x) turn.topRows<2>() *= -1;  // stood on its head
    return Quat(turn);
}

Shot shot_of(const FrameStore& store, const RenderSettings& wanted) {
    const Quat turn = drawn_from_up(wanted.up);
    RenderSettings settings = wanted;
    if (settings.color && settings.legend) settings.free_below = legend_share(settings.height);
    for (CameraKey& key : settings.camera) {
        for (std::optional<Vec3>* place : {&key.eye, &key.target}) {
            if (*place) *place = turn * **place;
        }
    }
    const double calm = wanted.follow ? kCalm * wanted.frame_rate.value() : 0;
    Shot shot{turn, std::move(settings), find_action(store, wanted, turn, calm), {}};
    if (shot.settings.open.any()) {
        shot.chosen = choose_view(store, shot.settings, shot.action, turn);
        shot.settings.camera = shot.chosen->camera;
    }
    return shot;
}

}  // namespace swage
