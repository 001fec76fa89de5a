// SPDX-License-Identifier: GPL-3.0-or-later
// One binary for every x86-64: the widest vectors are chosen when it starts. All kernels do the
// same exact operations lane by lane, so they give the same bytes.
#pragma once

#include "base/vector_targets.h"
#include "laws/lane_tensor.h"

namespace swage {

// What SWAGE_VECTOR_CLONES reckon with: where the machine's vectors are of four, gcc 12 takes those
// of eight through memory, and compares and chooses them number by number.
inline constexpr int kFewLanes = 4;
using FewLanes = LanesOf<kFewLanes>;

// Numbers in the vectors of the kernels that this machine runs: 8, 4 or 2.
int vector_width();
// Kernels of at most this width from now on; 0: as wide as the machine has them.
void limit_vector_width(int width);

}  // namespace swage
