// SPDX-License-Identifier: GPL-3.0-or-later
// How far bodies have gone into each other, where contact has not kept them apart.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

// Of each body, how deep any point of it lies in another, or of another in it, at most [m].
std::vector<double> body_overlaps(const std::vector<Aggregate*>& bodies, SimSettings settings);

}  // namespace swage
