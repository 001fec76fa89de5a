// SPDX-License-Identifier: GPL-3.0-or-later
// What flow has made of the volume of matter, which it should keep.
#pragma once

#include "laws/spring_frame.h"
#include "matter/aggregate.h"

namespace swage {

// A cell of springs as they lie, with what of their strains is elastic.
CellSprings<double> springs_of(const Aggregate& matter, CellId cell,
                               const std::array<ParticleId, 4>& row);

// What the matter would take up without any pressure, over what it was molded of. Cells that are
// severed or have broken, and those of two materials, count as at molding.
double flowed_volume(const Aggregate& matter);

}  // namespace swage
