// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff the points of one side of contacts are asked to be on another, and what steps leave of
// that: the same on all others that give alike, as the pieces of one body do, of which each would
// else have its own numbers for all points of the body.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

// Another side, as far as these ask.
struct OtherSide {
    double give;     // surface_modulus() over its spacing [Pa/m]
    double spacing;  // [m]
    double hold;     // of both, what sticks is torn off by [Pa]
    double scale;    // contact_stiffness
    double most;     // square of a swing that contacts may cause [1/s2]; 0: any
    bool is_itself;
    bool operator==(const OtherSide&) const = default;
};

struct PointStiffness {
    PointStiffness(const Aggregate& matter, const SurfacePoints& points, const OtherSide& other,
                   Solver solver);

    OtherSide on;
    std::vector<double> asked, stiffest, hold;  // of each point [N/m, N/m, N]
    double borne = 1;  // of what the other's points ask, as much as this side bears: see
                       // stiffest_on_body() in sim/limited_stiffness.h
};

}  // namespace swage
