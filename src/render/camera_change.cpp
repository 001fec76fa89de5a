// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/camera_change.h"

#include <algorithm>

namespace swage {

namespace {

bool has_eye(const CameraKey& key) { return key.eye && key.target; }

}  // namespace

bool stands_at_eye(const std::vector<CameraKey>& keys) {
    return std::any_of(keys.begin(), keys.end(), has_eye);
}

std::vector<CameraKey> changed_camera(std::vector<CameraKey> keys, const CameraChange& change) {
    if (!change.any()) return keys;
    std::erase_if(keys, has_eye);
    if (keys.empty()) keys.emplace_back();
    if (change.turn) {
        if (keys.front().at > 0) {
            keys.insert(keys.begin(), keys.front());
            keys.front().at = 0;
        }
        if (keys.back().at < 1) {
            keys.push_back(keys.back());
            keys.back().at = 1;
        }
    }
    const double start = change.azimuth.value_or(keys.front().azimuth);
    const double shift = start - keys.front().azimuth;
    for (CameraKey& key : keys) {
        key.azimuth = change.turn ? start + key.at * *change.turn : key.azimuth + shift;
        if (change.elevation) key.elevation = *change.elevation;
        if (change.zoom) key.zoom = *change.zoom;
        if (change.target) key.target = change.target;
        if (change.follows) key.target.reset();
    }
    return keys;
}

}  // namespace swage
