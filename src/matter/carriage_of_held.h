// SPDX-License-Identifier: GPL-3.0-or-later
// What a grip takes hold of: where it places a point and what it holds that by are asked here, so
// that it begins without a pull.
#pragma once

#include "matter/point_side.h"

namespace swage {

// The point's own cell, be it parted, as long as what carries the point hangs together there; else
// what does on its side (carriage_on_side), not whole where nothing does.
PointCarriage carriage_of_held(const Aggregate& matter, std::size_t point);

// By that, now [m].
Vec3 position_of_held(const Aggregate& matter, std::size_t point);

}  // namespace swage
