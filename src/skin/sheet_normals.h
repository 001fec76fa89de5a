// SPDX-License-Identifier: GPL-3.0-or-later
// To which side the triangles look that a blade sweeps, which tell none, as it may come back.
#pragma once

#include <array>
#include <vector>

#include "base/math.h"

namespace swage {

// Unit normals of the triangles that have an area: a list for each of the sheets that hang together
// by edges, whose ends agree to the bit. In a sheet all look to one side. Where two triangles turn
// by more than `most` (the cosine) at their edge, the sheet comes back there on the side it was on.
std::vector<std::vector<Vec3>> sheet_normals(const std::vector<std::array<Vec3, 3>>& sweep,
                                             double most);

}  // namespace swage
