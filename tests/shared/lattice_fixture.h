// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of matter made by hand from a signed distance, for tests of rooms that may not see `mold`.
#pragma once

#include <functional>

#include "tests/shared/block.h"

namespace swage::test {

using Distance = std::function<double(const Vec3&)>;  // negative inside [m]

Vec3 gradient_of(const Distance& distance, const Vec3& at, double reach);

// Fills the shape with cells of edge `a` over the box `low` to `low + a * count`. Each cell's fill
// is sampled; each half-cell that the surface passes through holds one surface point.
Aggregate make_shape(const Distance& distance, const Vec3& low, const Vec3i& count, double a);

// Severs every connection that crosses the plane, as a blade does: a particle on it counts as
// being on the positive side. Only connections whose middle satisfies `where`. The normal is kept
// as it would be of matter that is not turned.
void sever_plane(Aggregate& m, const Vec3& point, const Vec3& normal,
                 const std::function<bool(const Vec3&)>& where = nullptr);

// The same along a surface, in matter as molded, by how far a place lies from it [m].
void sever_along(Aggregate& m, const Distance& distance);

// Puts every particle where the map takes its reference position.
void deform(Aggregate& m, const std::function<Vec3(const Vec3&)>& map);

}  // namespace swage::test
