// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a skin that a blade has passed by stay whole, also where cells that it severed have
// carried them.
#pragma once

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "skin/mount.h"

namespace swage {

// A connected part of the skin that follows several pieces of the matter by severed cells alone is
// made to follow one: that which whole cells carry it by, without these that which most of it
// follows. Where whole cells carry it by several, a blade's path has run through it, and it is left
// as it is. To be called when blades have severed matter that no load has broken.
void follow_one_piece(const TriMesh& skin, Mount& mount, const Aggregate& matter);

// Where load has broken what blades had severed: a connected part of the skin that follows several
// pieces, as what lies beyond the particles of its side of a cut does, is made to follow the one
// that most of it follows of those that are nowhere more than a cell away. False where a part is
// beside no piece all over.
bool follow_piece_beside(const TriMesh& skin, Mount& mount, const Aggregate& matter);

}  // namespace swage
