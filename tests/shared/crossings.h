// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/trimesh.h"

namespace swage::test {

// Pairs of triangles that run through each other. Those that share an edge never do; of those that
// share a vertex, and at one place count as sharing it, the far edges count.
int crossings(const TriMesh& mesh);

}  // namespace swage::test
