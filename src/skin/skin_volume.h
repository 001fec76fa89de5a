// SPDX-License-Identifier: GPL-3.0-or-later
// The volume that a mounted skin encloses. Between particles half frames (carrier.h) round it, off
// the straight way by
//
//     d_v = 1/2 sum N_c G_c (X_v - X_c)                      over the corners c of its cell
//
// which is right for a surface that is as smooth, and too much where particles lie as folded as
// they do at the rim of what is pressed: matter that keeps its volume then has a skin that does
// not. Such a skin goes in, or out, by one share k of what it is rounded by around each particle,
//
//     x_v <- x_v - k sum N_c h_c,   h_c . n_v = |d_v . n_v|   of the vertices v around c, weighed
//                                                            by N_c and area, by least squares
//
// Faces that stay flat stay where they are, also beside an edge: for them h_c . n_v is to be 0.
//
// NOTE: of our own; the papers leave it open.
#pragma once

#include <optional>
#include <vector>

#include "geometry/trimesh.h"
#include "skin/mount.h"

namespace swage {

// What a skin encloses [m3] that is closed, else nothing.
std::optional<double> enclosed_volume(const TriMesh& skin, const std::vector<Vec3>& position);

// Lets a closed skin, mounted by half frames, enclose a volume [m3] as nearly as it can without
// going farther than it is rounded by in the mean (|k| <= 1). Others stay as they are. `skin`: its
// triangles count; `position`: where skin_positions() has its vertices.
void enclose_volume(const TriMesh& skin, const Mount& mount, const Aggregate& matter, double volume,
                    std::vector<Vec3>& position);

}  // namespace swage
