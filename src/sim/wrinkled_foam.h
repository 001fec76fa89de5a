// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Whether some of the foam in it is pressed so far that by its law its free sides wrinkle: at a
// stretch of 0.47 to 0.48 those of a block do. What such matter gives way by first are wrinkles as
// short as its cells, and these say nothing of what it would do.
bool foam_wrinkles(const Aggregate& matter);

}  // namespace swage
