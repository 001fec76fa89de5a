// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the true surface, carried by cells.
#pragma once

#include "matter/aggregate.h"
#include "mold/shares.h"

namespace swage {

SurfacePoints carry_patches(const std::vector<CellLayer>& layers, const Lattice& lattice,
                            const std::vector<float>& fill);

}  // namespace swage
