// SPDX-License-Identifier: GPL-3.0-or-later
// Matter of those cells of a box that are asked for, which may be several parts.
#pragma once

#include <functional>

#include "tests/shared/block.h"

namespace swage::test {

// Four surface points on each face that looks at no cell.
Aggregate make_cells(const Vec3& low, const Vec3i& count, double a, const Material& material,
                     const std::function<bool(const Vec3i&)>& is_wanted);

}  // namespace swage::test
