// SPDX-License-Identifier: GPL-3.0-or-later
// Points on the convex edges and corners of a body. A surface point stands in the middle of its
// patch, so that the nearest to an edge lie a quarter of a spacing inside: a body that comes with
// an edge or a corner first would be met that much later.
#pragma once

#include "matter/aggregate.h"

namespace swage {

// Where patches of two or three sides meet within half a cell, each gives the edge a quarter of its
// area, and the corner a sixteenth, and moves inward: Radau's rule, by which area and its first
// moments stay as they are, and along a straight patch the second too. The new point has the mean
// of what it is given, since one side at a time lies on what it meets. New points come after the
// others, which keep their carriers and numbers; of each the patch whose cell carries it.
std::vector<int> add_edge_points(const Aggregate& matter, SurfacePoints& points);

}  // namespace swage
