// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the work-piece's surface, as grips and loads choose them.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "machines/machine_spec.h"
#include "matter/aggregate.h"

namespace swage {

// The box around the patch of a surface point, as it lies now.
// NOTE: exact for flat sides along the lattice; that of a slanted one goes over into the next
// evenly.
Box patch_box(const Aggregate& matter, const Mat3& frame_from_world, std::size_t point,
              const Vec3& in_frame);

// How much of the patch lies in the region, 0 to 1.
double share_within(const Box& patch, const Box& region);

// By point: whether it is of the wall of a cavity, a closed surface that looks toward its own
// middle, as it was molded.
std::vector<char> cavity_walls(const Aggregate& matter);

// What of the surface looks to the side now and lies in the box (null: anywhere), both in the work
// frame. `in_work`: where the surface's points are in it.
SurfacePart find_region(const Aggregate& matter, const Pose& world_from_work,
                        const std::vector<Vec3>& in_work, Side side, const Box* box);

// Of the patch now; of one that no whole cell carries as it was molded [m2].
double patch_area(const Aggregate& matter, std::size_t point);

// A part of a surface that hangs together.
struct SurfaceComponent {
    double area;  // now [m2]
    Vec3 middle;  // of it, in the world [m]
};

// The largest first.
std::vector<SurfaceComponent> components_of(const Aggregate& matter, const SurfacePart& part);

// Whether the points make up whole closed surfaces: none of them has a neighbour that is left out.
bool are_whole_surfaces(const Aggregate& matter, const std::vector<int>& points);

}  // namespace swage
