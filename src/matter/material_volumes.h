// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a body each of its materials is.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// By number: at molding [m3], and [kg].
std::vector<double> material_volumes(const Aggregate& matter);
std::vector<double> material_masses(const Aggregate& matter);

}  // namespace swage
