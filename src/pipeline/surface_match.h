// SPDX-License-Identifier: GPL-3.0-or-later
// Which place of one skin of a body is which of another, where its skin was made anew.
#pragma once

#include <vector>

#include "geometry/triangle_tree.h"

namespace swage {

// Of points of a skin, `mounted` as it was and `here` in a frame, the nearest of the skin `other`,
// which is at `there` in another frame: as both were mounted or, where these lie nearer to each
// other, where the one was mounted at what the other had become, as a stage does that molds anew.
std::vector<TriangleTree::Nearest> match_surface(const std::vector<Vec3>& mounted,
                                                 const std::vector<Vec3>& here,
                                                 const TriMesh& other,
                                                 const std::vector<Vec3>& there);
// The shells of a skin of a body that it has in another frame: of each of `now` that which most of
// it is, by area. Faces that were made where matter parted lie on those of the other side and tell
// nothing where there are others.
std::vector<int> parent_shells(const TriMesh& now, const std::vector<Vec3>& here,
                               const Components& now_shells, const TriMesh& other,
                               const std::vector<Vec3>& there, const Components& other_shells);

// The places, in another frame, of a skin of a body that has the skin `other` there, at `there`:
// those of what is the same place, in the same shells.
std::vector<Vec3> carried_places(const TriMesh& now, const std::vector<Vec3>& here,
                                 const TriMesh& other, const std::vector<Vec3>& there);

// The mean of the triangle's corners.
Vec3 place_on(const TriangleTree::Nearest& nearest, const std::vector<Corners>& triangle,
              const std::vector<Vec3>& position);

}  // namespace swage
