// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces that a body is in, told of its skin.
#pragma once

#include <vector>

#include "geometry/trimesh.h"
#include "skin/mount.h"

namespace swage {

// Of which piece of the matter each triangle is the skin, the heaviest 0; of pieces alike that with
// the lowest particle first. Those that a triangle joins, as a boundary does what lies nearer than
// a cell, are one, and those without a triangle are left out.
std::vector<int> skin_pieces(const TriMesh& skin, const Mount& mount, const Aggregate& matter);

enum class SkinShare : char {
    none,
    joined,  // a connected part of it is another piece's too
    own
};
// What each of its pieces, as find_pieces() has them, has of the skin.
std::vector<SkinShare> skin_shares(const TriMesh& skin, const Mount& mount,
                                   const Aggregate& matter);

}  // namespace swage
