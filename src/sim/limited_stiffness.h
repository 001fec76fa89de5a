// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contacts and grips are asked to be, and what explicit steps leave of that.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

// Of the surface that a point stands for, what counts on a body [m2]: it pushes one cell there,
// which larger cells' points would drive in alone.
double area_on(const Aggregate& onto, const SurfacePoints& points, std::size_t point);

// Asked of each point of a body on another, by one way alone (sim/body_contact.h) [N/m].
std::vector<double> stiffness_on_body(const Aggregate& from, const SurfacePoints& points,
                                      const Aggregate& onto, double contact_stiffness,
                                      Solver solver);

// Points that are pressed alike.
struct LimitedPoints {
    std::vector<double> asked, stiffest;  // of each [N/m]; the second in steps of some length

    void add(const LimitedPoints& others);
    // What all of them have together of what they are asked, in steps shorter by this factor.
    double share(double shorter = 1) const;
};

// Of a body's whole surface as it is now, in steps of this length [s]: under tools that say nothing
// of their own; in grips; and where it meets another and that meets it.
LimitedPoints points_at_tools(const Aggregate& matter, const SimSettings& settings, double step);
LimitedPoints points_in_grips(const Aggregate& matter, const SimSettings& settings, double step);
LimitedPoints points_between(const Aggregate& one, const Aggregate& other,
                             const SimSettings& settings, double step);

}  // namespace swage
