// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the true surface whose cells a blade or a crack has parted.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Whether the cell that carries the point is no longer whole: it has no present place or area.
inline bool is_parted(const Aggregate& matter, std::size_t point) {
    return !matter.surface.is_loose(point) && !cell_is_whole(matter, matter.surface.row(point));
}

// Whether those that carry the point hang together in their cell no more: it would join what a
// blade or a crack has parted.
bool is_torn(const Aggregate& matter, std::size_t point);

}  // namespace swage
