// SPDX-License-Identifier: GPL-3.0-or-later
// Which cell of a body is where: for what is molded anew in its place.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Of the cells whose box, so much wider [m] on every side, holds the place that with the nearest
// middle; outside all, of all.
std::vector<CellId> cells_there(const Aggregate& body, const std::vector<Vec3>& place,
                                double wider = 0);

}  // namespace swage
