// SPDX-License-Identifier: GPL-3.0-or-later
// Which cell of a body is where: for what is molded anew in its place.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

// Of the cells whose box, so much wider [m] on every side, holds the place that with the nearest
// middle; outside all, of all.
std::vector<CellId> cells_there(const Aggregate& body, const std::vector<Vec3>& place,
                                double wider = 0);

// The same of those cells alone that suit a place: of those whose box holds it, else of those
// within a spacing of it, else of all; -1: none does.
std::vector<CellId> suited_cells_there(
    const Aggregate& body, const std::vector<Vec3>& place,
    const std::function<bool(std::size_t place, CellId cell)>& suits);

}  // namespace swage
