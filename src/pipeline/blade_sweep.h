// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that the edges of a machine's blades pass over during a stage.
#pragma once

#include <array>
#include <vector>

#include "machines/machine.h"

namespace swage {

// World positions [m], two triangles for each piece of edge and frame.
std::vector<std::array<Vec3, 3>> blade_sweep(const Machine& machine, int frames, double duration);

}  // namespace swage
