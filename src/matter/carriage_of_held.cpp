// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/carriage_of_held.h"

#include "matter/parted.h"

namespace swage {

PointCarriage carriage_of_held(const Aggregate& matter, std::size_t point) {
    if (is_torn(matter, point)) return carriage_on_side(matter, point);
    return {matter.surface.row(point), matter.surface.place(point)};
}

// NOTE: of what is not torn, as of a loose particle, the surface itself tells it.
Vec3 position_of_held(const Aggregate& matter, std::size_t point) {
    return is_torn(matter, point) ? carriage_on_side(matter, point).position(matter)
                                  : matter.surface_position(point);
}

}  // namespace swage
