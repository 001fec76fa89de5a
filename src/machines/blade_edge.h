// SPDX-License-Identifier: GPL-3.0-or-later
// A blade's edge as points, and where it goes first.
#pragma once

#include <vector>

#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

// In the work frame [m]. One that comes back to where it begins ends with that very point. Throws
// PlacedError where it has no length.
std::vector<Vec3> edge_of(const BladeSpec& spec, const Variables& known);

// Of all that it goes from where it starts, the farthest on the side to which it goes first: it may
// come back by more. Zero where it stands.
Vec3 farthest_forth(const std::vector<Vec3>& way);

}  // namespace swage
