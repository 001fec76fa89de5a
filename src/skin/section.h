// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles that fill a plane section of a body, holes left out.
#pragma once

#include <optional>
#include <vector>

#include "base/math.h"
#include "geometry/trimesh.h"

namespace swage {

struct Section {
    std::vector<Vec2> point;
    std::vector<Vec3> at_rest;                // where each was in the body at molding
    std::vector<std::array<int, 2>> segment;  // closed loops, the inside on the left
    std::vector<Vec2> wish;                   // places inside that should become points
    double spacing = 0;                       // [m] of the points that are added inside
    std::vector<std::array<int, 2>> line;     // inside, that become edges too (section_lines.h)
    // More than 0 of a section around the origin of a path round an axis, at this distance of which
    // [m] the band lies: it is filled as it is there, though farther out here it is drawn wider.
    double radius = 0;
};

struct SectionTriangles {
    std::vector<Vec2> added;        // points inside; their ids follow those of the section's
    std::vector<Corners> triangle;  // counter-clockwise
};

// Every segment and line becomes an edge of the triangles. Nothing when the segments cross or touch
// each other, do not close, or wind more than once around a place.
std::optional<SectionTriangles> fill_section(const Section& section);

}  // namespace swage
