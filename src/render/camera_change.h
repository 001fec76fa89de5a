// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of which a part is asked for anew, as on the command line.
#pragma once

#include <optional>
#include <vector>

#include "render/settings.h"

namespace swage {

// Angles in radians, as in CameraKey. What is absent stays as it is.
struct CameraChange {
    std::optional<double> azimuth = {};  // where the flight begins; it goes on from there as it did
    std::optional<double> elevation = {}, zoom = {};  // all through the flight
    std::optional<double> turn = {};                  // how far it goes round, evenly
    std::optional<Vec3> target = {};                  // looked at all through the flight [m]
    bool follows = false;                             // the bodies, whatever it looks at else
    bool any() const { return azimuth || elevation || zoom || turn || target || follows; }
};

bool stands_at_eye(const std::vector<CameraKey>& keys);  // at any of them

// Keys with eye and target give way to any change: of those nothing else is left.
std::vector<CameraKey> changed_camera(std::vector<CameraKey> keys, const CameraChange& change);

}  // namespace swage
