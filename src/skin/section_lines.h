// SPDX-License-Identifier: GPL-3.0-or-later
// Lines that are drawn on a plane section of a body and that its triangles are to keep to.
#pragma once

#include <array>
#include <vector>

#include "skin/section.h"

namespace swage {

struct LinePoint {
    int segment;   // of the section as it was, on which it lies; -1: inside
    double share;  // of the way along that
};

// Gives a section those parts of the lines that lie inside it: its points, the segments that it
// has, divided where a line ends on them, and its lines. Lines are drawn to points of the section,
// of each other and to segments within `reach` [m], and end where they cross any. Returns what each
// point that is added is, in their order: first those on segments, in the order of these and along
// each.
std::vector<LinePoint> add_lines(const std::vector<std::array<Vec2, 2>>& lines, double reach,
                                 Section& section);

}  // namespace swage
