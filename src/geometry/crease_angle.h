// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/math.h"

namespace swage {

// Between faces [rad]: where they meet at more, and no file says how, their edge is sharp.
inline constexpr double kCreaseAngle = 40 * kPi / 180;

}  // namespace swage
