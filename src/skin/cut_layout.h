// SPDX-License-Identifier: GPL-3.0-or-later
// Texture coordinates of cut faces, for who puts an image on them. Stills show none.
#pragma once

#include "geometry/trimesh.h"

namespace swage {

// Of cut faces (is_cut_look()) that have none: the place at molding, seen along the axis that the
// face lies most across, [m], so that what holds together goes on from face to face and stays in
// every frame. `skin`: its positions at molding.
void lay_out_cuts(TriMesh& skin);

}  // namespace swage
