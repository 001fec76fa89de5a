// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/math.h"

namespace swage {

// A point of the surface that something holds or presses on.
struct HeldPoint {
    int point;       // into Aggregate::surface
    Mat3 stiffness;  // [N/m]
};

}  // namespace swage
