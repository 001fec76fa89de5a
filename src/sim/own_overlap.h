// SPDX-License-Identifier: GPL-3.0-or-later
// How far a body has gone into itself, where nothing has kept it from that.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// The deepest that a point of the surface lies in the body, beyond its own neighbourhood [m].
double own_overlap(Aggregate& matter);

}  // namespace swage
