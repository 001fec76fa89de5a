// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "matter/aggregate.h"

namespace swage {

// Deformation gradient of the trilinear map of a cell with these corners, at a place in it or
// beyond.
Mat3 cell_gradient(const Aggregate& matter, const std::array<ParticleId, 8>& corner,
                   const Vec3& place);

}  // namespace swage
